"use strict";
(() => {
const report = JSON.parse(document.getElementById("data").textContent);

const kDerivatives = [
  {name: "position", per: ""},
  {name: "velocity", per: "/s"},
  {name: "acceleration", per: "/s²"},
  {name: "jerk", per: "/s³"},
];
// Okabe and Ito's colours without yellow, which white swallows; black is for waypoints.
const kColors = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#666666"];
// The first is drawn through, so that it shows in the gaps of a curve that lies on it.
const kDashes = [[], [8, 4], [3, 3], [10, 3, 3, 3], [14, 5]];
const kLabelWidth = 70;     // px of an axis label
const kMarkSpacing = 7;     // px between marks that are drawn large
const kTickSpacing = 3;     // px between those that are drawn small
const kPadding = 0.06;      // of the values' range, above and below
const kTimePadding = 0.01;  // of the duration, before and after
const kSharpSections = 16;  // that are printed sharply; more would take too much memory

// `#draw=all` draws every chart at once; `&time=FROM,TO` zooms them, in seconds.
const address = new URLSearchParams(location.hash.slice(1));

const whole = report.duration > 0
    ? [-kTimePadding * report.duration, (1 + kTimePadding) * report.duration]
    : [-1.05, 1.05];

function element(parent, tag, text, className) {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  if (className) made.className = className;
  parent.append(made);
  return made;
}

function short(value) {
  return value === null ? "–" : String(Number(value.toPrecision(6)));
}

function unit_of(dimension, r) {
  const unit = dimension.unit || "unit";
  return (r > 0 && unit.includes("/") ? `(${unit})` : unit) + kDerivatives[r].per;
}

function axis_title(dimension, r) {
  return `${kDerivatives[r].name} [${unit_of(dimension, r)}]`;
}

const color_of = (c) => kColors[c % kColors.length];
const dash_of = (c) => kDashes[c % kDashes.length];

// Ticks at multiples of 1, 2 or 5 powers of ten, with the digits that tell them apart.
function ticks(low, high, most) {
  const rough = (high - low) / Math.max(most, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
  const digits = Math.floor(Math.log10(step) + 1e-9);
  const size = Math.floor(Math.log10(Math.max(Math.abs(low), Math.abs(high))));
  const label = (v) => {
    if (v === 0) return "0";
    if (size < 6 && digits > -6) return v.toFixed(Math.max(0, -digits));
    return `${(v / 10 ** size).toFixed(Math.max(0, size - digits))}e${size}`;
  };
  const made = [];
  for (let i = Math.ceil(low / step); i <= Math.floor(high / step); ++i) {
    made.push({v: i * step, label: label(i * step)});
  }
  return made;
}

// First row at or after a time.
function row_at(seconds) {
  let [low, high] = [0, report.seconds.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (report.seconds[middle] < seconds) low = middle + 1;
    else high = middle;
  }
  return low;
}

// Least and greatest of what a chart shows between two times, waypoints included.
function extent(dimension, r, [from, to]) {
  let [low, high] = [Infinity, -Infinity];
  const consider = (value) => {
    if (value === null) return;
    low = Math.min(low, value);
    high = Math.max(high, value);
  };
  const first = Math.max(0, row_at(from) - 1);
  for (const curve of dimension.curves) {
    const values = curve.values[r];
    for (let i = first; i < values.length; ++i) {
      consider(values[i]);
      if (report.seconds[i] > to) break;
    }
  }
  if (r > 0) return [low, high];
  report.waypoint_seconds.forEach((t, i) => {
    if (t >= from && t <= to) consider(dimension.waypoints[i]);
  });
  return [low, high];
}

// The values a chart spans. Those that differ by rounding only make a flat line, not a noise.
function value_range(dimension, r, times) {
  const [low, high] = extent(dimension, r, times);
  if (!(high >= low)) return [-1.05, 1.05];
  if (high - low > dimension.resolution[r]) {
    const padding = kPadding * (high - low);
    return [low - padding, high + padding];
  }
  const middle = Math.max(Math.abs(low), Math.abs(high)) > dimension.resolution[r] ? low : 0;
  const half = 1.05 * (Math.abs(middle) * 0.1 || 1);
  return [middle - half, middle + half];
}

function inside(times, [from, to]) {
  return times.map((t, i) => [t, i]).filter(([t]) => t >= from && t <= to);
}

// Marks of `times` that are seen, as [time, index], and whether there is room to draw them large.
function seen(times, area, g) {
  const [from, to] = g.xAxisRange();
  const marks = times.map((t, i) => [t, i]).filter(([t]) => t >= from && t <= to);
  return {marks, large: marks.length * kMarkSpacing <= area.w};
}

// Lines at the knots, behind the curves; where they crowd, ticks at the bottom of every 2nd, 4th…
function draw_knots(chart, ctx, area, g) {
  const {marks, large} = seen(report.knot_seconds, area, g);
  let every = 1;
  while (marks.length / every * kTickSpacing > area.w) every *= 2;
  ctx.strokeStyle = large ? "#c4c4c4" : "#999";
  ctx.lineWidth = 1;
  ctx.beginPath();
  for (const [t, i] of marks) {
    if (i % every !== 0) continue;
    const x = Math.round(g.toDomXCoord(t)) + 0.5;
    ctx.moveTo(x, area.y + (large ? 0 : area.h - 6));
    ctx.lineTo(x, area.y + area.h);
  }
  ctx.stroke();
  chart.plot.dataset.knots = marks.length;
}

function draw_circles(chart, marks, ctx, g, radius) {
  for (const [t, i] of marks) {
    ctx.beginPath();
    ctx.arc(g.toDomXCoord(t), g.toDomYCoord(chart.dimension.waypoints[i]), radius, 0, 2 * Math.PI);
    ctx.fill();
    if (ctx.strokeStyle !== ctx.fillStyle) ctx.stroke();
  }
}

// Rings at the waypoints, over the curves; where they crowd, dots behind the curves.
function draw_waypoints(chart, ctx, area, g, in_front) {
  const {marks, large} = seen(report.waypoint_seconds, area, g);
  chart.plot.dataset.waypoints = marks.length;
  if (large !== in_front) return;
  ctx.save();
  ctx.beginPath();
  ctx.rect(area.x, area.y, area.w, area.h);
  ctx.clip();
  ctx.lineWidth = 1.2;
  ctx.strokeStyle = large ? "#000" : "#999999";
  ctx.fillStyle = large ? "#fff" : "#999999";
  draw_circles(chart, marks, ctx, g, large ? 3 : 2.5);
  ctx.restore();
}

function draw_crosshair(g, x) {
  const area = g.getArea();
  const ctx = g.canvas_ctx_;
  ctx.save();
  ctx.strokeStyle = "#777";
  ctx.setLineDash([3, 3]);
  ctx.beginPath();
  ctx.moveTo(Math.round(x) + 0.5, area.y);
  ctx.lineTo(Math.round(x) + 0.5, area.y + area.h);
  ctx.stroke();
  ctx.restore();
}

// What draws besides dygraphs itself.
function marks(chart) {
  return {
    activate: () => ({
      willDrawChart: ({drawingContext, dygraph}) => {
        const area = dygraph.getArea();
        if (chart.r > 0) draw_knots(chart, drawingContext, area, dygraph);
        else draw_waypoints(chart, drawingContext, area, dygraph, false);
      },
      didDrawChart: ({drawingContext, dygraph}) => {
        if (chart.r > 0) return;
        draw_waypoints(chart, drawingContext, dygraph.getArea(), dygraph, true);
      },
      select: (e) => draw_crosshair(e.dygraph, e.dygraph.toDomXCoord(e.selectedX)),
    }),
  };
}

function rows_of(chart) {
  const columns = chart.dimension.curves.map((curve) => curve.values[chart.r]);
  return report.seconds.map((t, i) => [t, ...columns.map((values) => values[i])]);
}

function show_values(section, row) {
  for (const {values, time, r} of section.charts) {
    values.forEach((value, c) => {
      value.textContent = row < 0 ? "" : short(section.dimension.curves[c].values[r][row]);
    });
    time.textContent = row < 0 ? "" : `t = ${short(report.seconds[row])} s`;
  }
}

function select(section, row) {
  for (const chart of section.charts) {
    if (row < 0) chart.graph.clearSelection();
    else chart.graph.setSelection(row);
  }
  show_values(section, row);
}

// Shows the same time in all charts of a section, each with the values it has there.
function zoom(section, times) {
  if (section.zooming) return;
  section.zooming = true;
  section.times = times;
  for (const {graph, r} of section.charts) {
    graph.updateOptions({
      dateWindow: times,
      axes: {y: {valueRange: value_range(section.dimension, r, times)}},
    });
  }
  section.zooming = false;
}

// Tells what is seen, and takes over a time that this chart was zoomed to.
function drawn(section, chart, g) {
  const times = g.xAxisRange();
  chart.plot.dataset.times = times.join(" ");
  chart.plot.dataset.range = g.yAxisRange().join(" ");
  if (section.charts.some(({graph}) => graph === g) && times.some((t, i) => t !== section.times[i])) {
    zoom(section, times);
  }
}

function options(section, chart) {
  const {dimension, r} = chart;
  // Without the label that would lie in the corner.
  const y_ticks = (low, high, pixels) =>
      ticks(low, high, pixels / 28).filter(({v}) => v - low > 0.04 * (high - low));
  return {
    labels: ["time", ...report.curves.map((name, c) => `${c} ${name}`)],
    colors: report.curves.map((_, c) => color_of(c)),
    series: Object.fromEntries(report.curves.map(
        (name, c) => [`${c} ${name}`, {strokePattern: dash_of(c).length ? dash_of(c) : null}])),
    strokeWidth: 1.6,
    legend: "never",
    xlabel: "time [s]",
    xLabelHeight: 16,
    yLabelWidth: 16,
    axisLabelFontSize: 11,
    gridLineColor: "#ececec",
    axisLineColor: "#555",
    dateWindow: section.times,
    rightGap: 28,
    highlightCircleSize: 3,
    axes: {
      x: {ticker: (low, high, pixels) => ticks(low, high, pixels / 90), axisLabelWidth: 54},
      y: {
        ticker: y_ticks,
        axisLabelWidth: kLabelWidth,
        valueRange: value_range(dimension, r, section.times),
      },
    },
    ylabel: axis_title(dimension, r).replace(/&/g, "&amp;").replace(/</g, "&lt;"),
    plugins: [marks(chart)],
    interactionModel: {
      ...Dygraph.defaultInteractionModel,
      dblclick: () => zoom(section, whole),
    },
    highlightCallback: (event, x, points, row) => select(section, row),
    unhighlightCallback: () => show_values(section, -1),
    drawCallback: (g) => drawn(section, chart, g),
  };
}

function draw(section) {
  if (section.drawn) return;
  section.drawn = true;
  for (const chart of section.charts) {
    chart.graph = new Dygraph(chart.plot, rows_of(chart), options(section, chart));
  }
}

// Frees the memory of the charts, which stay blank until they are drawn again.
function release(section) {
  if (!section.drawn) return;
  section.drawn = false;
  for (const chart of section.charts) {
    chart.graph.destroy();
    chart.graph = null;
  }
}

function swatch(parent, content) {
  const made = element(parent, "span", undefined, "curve");
  made.innerHTML = `<svg width="30" height="10" aria-hidden="true">${content}</svg>`;
  return made;
}

function make_legend(chart, parent) {
  const legend = element(parent, "div", undefined, "legend");
  chart.values = report.curves.map((name, c) => {
    const entry = swatch(legend, `<line x1="0" x2="30" y1="5" y2="5" stroke="${color_of(c)}"
        stroke-width="2" stroke-dasharray="${dash_of(c).join(" ")}"/>`);
    element(entry, "span", name, "name");
    return element(entry, "span", "", "value");
  });
  const mark = chart.r === 0
      ? `<circle cx="15" cy="5" r="3" fill="#fff" stroke="#000"/>`
      : `<line x1="15" x2="15" y1="0" y2="10" stroke="#aaa"/>`;
  element(swatch(legend, mark), "span", chart.r === 0 ? "waypoint" : "knot", "name");
  chart.time = element(legend, "span", "", "time");
}

function make_chart(dimension, r, parent) {
  const figure = element(parent, "div", undefined, "chart");
  const chart = {dimension, r, graph: null};
  make_legend(chart, figure);
  chart.plot = element(figure, "div", undefined, "plot");
  chart.plot.dataset.derivative = kDerivatives[r].name;
  chart.plot.dataset.rows = report.seconds.length;
  return chart;
}

// The cells of a value and its time; `rounding` is what cannot be told from 0.
function value_cells(row, [value, time], rounding = -1) {
  const none = Math.abs(value) <= rounding;
  element(row, "td", none ? "≈ 0" : short(value)).dataset.value = value;
  element(row, "td", none ? "" : short(time));
}

function make_rows(body, dimension, c, with_distance) {
  const curve = dimension.curves[c];
  curve.table.forEach((measured, r) => {
    const row = element(body, "tr");
    if (r === 0) element(row, "th", report.curves[c]).rowSpan = curve.table.length;
    element(row, "th", axis_title(dimension, r));
    value_cells(row, measured.least);
    value_cells(row, measured.greatest);
    value_cells(row, measured.step, dimension.resolution[r]);
    if (!with_distance) return;
    if (r === 0) value_cells(row, curve.distance, dimension.resolution[0]);
    else element(row, "td").colSpan = 2;
  });
}

function make_table(dimension, parent) {
  const with_distance =
      dimension.curves.some(({distance}) => distance[0] > dimension.resolution[0]);
  const table = element(element(parent, "div", undefined, "scroll"), "table");
  element(table, "caption", "Extremes over the whole curve and the largest step at a knot" +
      (with_distance ? "; distance is the largest from a waypoint" : "") +
      ". What is ≈ 0 is no more than rounding.");
  const head = element(element(table, "thead"), "tr");
  const titles = ["curve", "quantity", "least", "at [s]", "greatest", "at [s]", "step", "at [s]"];
  if (with_distance) titles.push("distance", "at [s]");
  for (const title of titles) element(head, "th", title);
  report.curves.forEach((_, c) => {
    make_rows(element(table, "tbody"), dimension, c, with_distance);
  });
}

function make_section(dimension, index) {
  const node = element(document.getElementById("dimensions"), "section");
  node.id = `dimension-${index}`;
  element(node, "h2", dimension.name + (dimension.unit ? ` [${dimension.unit}]` : ""));
  const section = {node, dimension, times: first_times(), drawn: false, zooming: false};
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
  item("Waypoints", String(report.count));
  item("Duration", `${short(report.duration)} s`);
  if (report.intervals) {
    item("Intervals: least, median, most", report.intervals.map(short).join(", ") + " s");
  }
  item("Time 0", `${report.origin_ns} ns`);
  item("Curves", report.curves.join(", "));
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
    element(notes, "p", "A lone waypoint: the curve holds its position.");
  }
  if (report.bucket > 0) {
    element(notes, "p", `This recording is long: each ${short(report.bucket)} s are drawn as their ` +
        "least and greatest value. The tables are exact.");
  }
  if (report.stride > 1) {
    element(notes, "p", "Not all waypoints and knots are marked: 4000 at the most.");
  }
  element(notes, "p", "Charts drawn with dygraphs (MIT licence).");
}

// Draws sections when they come near the window and frees them when they are far from it.
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

// Fits the charts to the page, with `scale` dots per CSS pixel; null: as many as the screen has.
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
make_notes();
if (address.get("draw") === "all") sections.forEach(draw);
else watch(sections);
addEventListener("beforeprint", () => prepare_print(sections));
addEventListener("afterprint", () => finish_print(sections));
})();
