// The page of a latency report, except the charts.

const result = JSON.parse(document.getElementById("data").textContent);
const content = document.getElementById("content");

const us = (ns) => (ns / 1e3).toFixed(2);

function make_summary() {
  const list = document.getElementById("summary");
  const item = (name, value) => {
    const pair = element(list, "div");
    element(pair, "dt", name);
    element(pair, "dd", value === null || value === "" ? "–" : String(value));
  };
  for (const facts of [result.options, result.environment, result.clock]) {
    for (const [name, value] of Object.entries(facts)) item(name.replace(/_/g, " "), value);
  }
  for (const warning of result.warnings) {
    element(document.getElementById("warnings"), "li", warning);
  }
}

// The percentiles of a series, grey if fewer than ten samples are above.
function make_row(body, series) {
  const row = element(body, "tr");
  element(row, "th", series.name);
  element(row, "th", series.from);
  element(row, "td", String(series.count));
  for (const {ns, enough, above} of series.percentiles) {
    element(row, "td", us(ns), enough ? undefined : "few").title = `${above} samples above`;
  }
  element(row, "td", us(series.max_ns));
  element(row, "td", series.missed === undefined ? "" : String(series.missed));
}

function make_table(all) {
  const table = element(element(content, "div", undefined, "scroll"), "table");
  element(table, "caption", "Latencies in µs, from the intended instant; raw: from the start of " +
      "the append. Grey: fewer than ten samples are above.");
  const head = element(element(table, "thead"), "tr");
  const percents = all[0].percentiles.map(({percent}) => `${percent} %`);
  for (const title of ["stage", "from", "count", ...percents, "max", "missed"]) {
    element(head, "th", title);
  }
  const body = element(table, "tbody");
  for (const series of all) make_row(body, series);
}

function make_processes() {
  element(content, "h2", "Processes");
  const table = element(element(content, "div", undefined, "scroll"), "table");
  const head = element(element(table, "thead"), "tr");
  for (const title of Object.keys(result.processes[0])) element(head, "th", title.replace(/_/g, " "));
  const body = element(table, "tbody");
  for (const process of result.processes) {
    const row = element(body, "tr");
    Object.values(process).forEach((value, i) => element(row, i ? "td" : "th", String(value)));
  }
}

function make_notes() {
  const notes = document.getElementById("notes");
  for (const [name, reason] of Object.entries(result.not_measured)) {
    element(notes, "p", `Not measured: ${name}: ${reason}.`);
  }
  element(notes, "p", "Charts drawn with dygraphs (MIT licence).");
}

make_summary();
const measured = result.series.filter(({count}) => count > 0);
if (measured.length > 0) {
  make_table(measured);
  element(content, "h2", "Percentiles");
  draw_percentiles(content, measured);
}
for (const series of measured.filter(({over_time}) => over_time)) {
  element(content, "h2", `Over time: ${series.name}, from the intended instant`);
  draw_over_time(content, series);
}
make_processes();
make_notes();
