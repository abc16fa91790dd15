// The page, except the charts: summary, notes, drawing on demand, printing.

function make_section(dimension, index) {
  const node = element(document.getElementById("dimensions"), "section");
  node.id = `dimension-${index}`;
  element(node, "h2", dimension.name + (dimension.unit ? ` [${dimension.unit}]` : ""));
  const section = {node, dimension, times: first_times(), drawn: false, zooming: false};
  section.coarse = element(node, "p", `This zoom exceeds the resolution of the charts: for each interval ` +
      `of ${short(report.bucket)} s they show only the least and greatest value.`, "coarse");
  section.coarse.hidden = true;
  section.charts = kDerivatives.map((_, r) => make_chart(dimension, r, node));
  make_table(dimension, node);
  return section;
}

function first_times() {
  const asked = (address.get("time") || "").split(",").map(Number);
  return asked.length === 2 && asked[0] < asked[1] ? asked : whole;
}

function make_summary() {
  document.title = report.title;
  document.getElementById("title").textContent = report.title;
  const list = document.getElementById("summary");
  const item = (name, text) => {
    const pair = element(list, "div");
    element(pair, "dt", name);
    element(pair, "dd", text);
  };
  const missed = report.missed_seconds.length;
  item("Waypoints", String(report.count) + (missed > 0 ? `, and ${missed} not met` : ""));
  item("Duration", `${short(report.duration)} s`);
  if (report.intervals) {
    item("Intervals: least, median, greatest", report.intervals.map(short).join(", ") + " s");
  }
  item("Time 0", `${report.origin_ns} ns`);
  item("Curves", report.curves.join(", "));
}

// The events in order of time; a click shows the half second around one in all charts.
function make_events(sections) {
  if (report.marks.length === 0) return;
  const node = document.getElementById("events");
  element(node, "h2", "Events");
  const body = element(element(element(node, "div", undefined, "scroll"), "table"), "tbody");
  for (const {at, text} of report.marks) {
    const row = element(body, "tr");
    element(row, "td", `${at.toFixed(6)} s`);
    element(row, "td", text);
    row.addEventListener("click", () => {
      for (const section of sections) {
        if (section.drawn) zoom(section, [at - kAround, at + kAround]);
        else section.times = [at - kAround, at + kAround];
      }
    });
  }
}

function make_contents() {
  if (report.dimensions.length < 2) return;
  report.dimensions.forEach((dimension, i) => {
    const link = element(document.getElementById("contents"), "a", dimension.name);
    link.href = `#dimension-${i}`;
  });
}

function make_notes() {
  const notes = document.getElementById("notes");
  if (report.duration === 0) {
    element(notes, "p", "A single waypoint: the curve holds its position.");
  }
  if (report.bucket > 0) {
    element(notes, "p", `This recording is long: for each interval of ${short(report.bucket)} s the ` +
        "charts show the least and greatest value. The tables are exact.");
  }
  if (report.stride > 1) {
    element(notes, "p", "Only some waypoints and knots are marked, at most 4000.");
  }
  element(notes, "p", "Charts drawn with dygraphs (MIT licence).");
}

// Draws the sections near the window and frees the others.
function watch(sections) {
  const watcher = new IntersectionObserver((entries) => {
    for (const {target, isIntersecting} of entries) {
      const section = sections.find(({node}) => node === target);
      if (isIntersecting) draw(section);
      else if (!document.body.classList.contains("printing")) release(section);
    }
  }, {rootMargin: "800px 0px"});
  for (const {node} of sections) watcher.observe(node);
}

// Fits the charts to the page, with `scale` dots per CSS pixel; null: as on the screen.
function resize(sections, scale) {
  for (const {charts} of sections) {
    for (const {graph} of charts) {
      if (!graph) continue;
      graph.updateOptions({pixelRatio: scale}, true);
      graph.resize();
    }
  }
}

function prepare_print(sections) {
  document.body.classList.add("printing");
  sections.forEach(draw);
  resize(sections, sections.length <= kSharpSections ? 2 : null);
}

function finish_print(sections) {
  document.body.classList.remove("printing");
  resize(sections, null);
}

make_summary();
make_contents();
const sections = report.dimensions.map(make_section);
make_events(sections);
make_notes();
if (address.get("draw") === "all") sections.forEach(draw);
else watch(sections);
addEventListener("beforeprint", () => prepare_print(sections));
addEventListener("afterprint", () => finish_print(sections));
