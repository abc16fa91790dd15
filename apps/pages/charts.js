// The charts of a dimension.

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

// Shows the same time range in all charts of a section, each with its own range of values.
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

// Records the visible ranges. If the user zoomed this chart, shows its time range in the others.
function drawn(section, chart, g) {
  const times = g.xAxisRange();
  chart.plot.dataset.times = times.join(" ");
  chart.plot.dataset.range = g.yAxisRange().join(" ");
  section.coarse.hidden = report.bucket / (times[1] - times[0]) * g.getArea().w < kCoarse;
  if (section.charts.some(({graph}) => graph === g) && times.some((t, i) => t !== section.times[i])) {
    zoom(section, times);
  }
}

function options(section, chart) {
  const {dimension, r} = chart;
  // Omits the label in the corner.
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
  const further = (content, name) => element(swatch(legend, content), "span", name, "name");
  for (const kind of new Set(report.spans.map((span) => span.kind))) {
    further(`<rect x="5" width="20" height="10" fill="${kSpanColors[kind]}"/>`, kind);
  }
  if (chart.r === 0 && report.missed_seconds.length > 0) {
    further(`<path d="M12 2L18 8M12 8L18 2" stroke="#c00000"/>`, "waypoint not met");
  }
  if (report.marks.length > 0) {
    further(`<line x1="15" x2="15" y1="0" y2="10" stroke="#7b3294" stroke-dasharray="6 3"/>`, "event");
  }
  if (chart.dimension.limits[chart.r].some((value) => value !== null)) {
    further(`<line x1="0" x2="30" y1="5" y2="5" stroke="#c00000" stroke-dasharray="2 3"/>`, "limit");
  }
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
