// The charts of a latency report. Latencies are drawn as the logarithm of microseconds.

const kRatioTicks = [1, 2, 10, 100, 1e3, 1e4, 1e5, 1e6, 1e7];  // of 1/(1 − share)

const log_us = (ns) => Math.log10(Math.max(ns, 1) / 1e3);

function us_label(value) {
  const us = 10 ** value;
  if (us >= 1e6) return `${short(us / 1e6)} s`;
  if (us >= 1e3) return `${short(us / 1e3)} ms`;
  return `${short(us)} µs`;
}

function us_ticks(low, high) {
  const made = [];
  for (let power = Math.floor(low); power <= Math.ceil(high); ++power) {
    for (const digit of high - low < 4 ? [1, 2, 5] : [1]) {
      const v = power + Math.log10(digit);
      if (v >= low && v <= high) made.push({v, label: us_label(v)});
    }
  }
  return made;
}

// Labels of ratios: "99.9 %" for 1000.
function share_ticks(low, high) {
  return kRatioTicks.map((ratio) => ({v: Math.log10(ratio), label: `${short(100 - 100 / ratio)} %`}))
      .filter(({v}) => v >= low - 1e-9 && v <= high + 1e-9);
}

function make_plot(parent, name, className) {
  const plot = element(parent, "div", undefined, className);
  plot.dataset.name = name;
  return plot;
}

function chart_options(labels, xlabel) {
  return {
    labels,
    legend: "never",
    xlabel,
    ylabel: "latency",
    xLabelHeight: 16,
    yLabelWidth: 16,
    axisLabelFontSize: 11,
    gridLineColor: "#ececec",
    axisLineColor: "#555",
    rightGap: 28,
  };
}

function make_legend(parent, names, color, dash) {
  const legend = element(parent, "div", undefined, "legend");
  return names.map((name, c) => {
    const entry = element(legend, "span", undefined, "curve");
    entry.innerHTML = `<svg width="30" height="10" aria-hidden="true"><line x1="0" x2="30" y1="5"
        y2="5" stroke="${color(c)}" stroke-width="2" stroke-dasharray="${dash(c).join(" ")}"/></svg>`;
    element(entry, "span", name, "name");
    return element(entry, "span", "", "value");
  });
}

// The percentile curves of all series. Raw ones are dashed in the colour of their stage.
function draw_percentiles(parent, all) {
  const stages = [...new Set(all.map(({name}) => name))];
  const color = (c) => color_of(stages.indexOf(all[c].name));
  const dash = (c) => all[c].from === "raw" ? [6, 4] : [];
  const names = all.map(({name, from}) => from === "raw" ? `${name}, raw` : name);
  const values = make_legend(parent, names, color, dash);
  const rows = new Map();
  all.forEach(({curve}, c) => {
    for (const [ratio, ns] of curve) {
      const x = Math.log10(ratio);
      if (!rows.has(x)) rows.set(x, all.map(() => null));
      rows.get(x)[c] = log_us(ns);
    }
  });
  const sorted = [...rows].sort(([a], [b]) => a - b).map(([x, row]) => [x, ...row]);
  const plot = make_plot(parent, "percentiles", "plot tall");
  plot.dataset.series = all.length;
  plot.dataset.rows = sorted.length;
  const labels = names.map((name, c) => `${c} ${name}`);
  return new Dygraph(plot, sorted, {
    ...chart_options(["share", ...labels], "percentile"),
    colors: all.map((_, c) => color(c)),
    series: Object.fromEntries(
        labels.map((label, c) => [label, {strokePattern: dash(c).length ? dash(c) : null}])),
    strokeWidth: 1.6,
    connectSeparatedPoints: true,
    axes: {x: {ticker: share_ticks, axisLabelWidth: 64}, y: {ticker: us_ticks, axisLabelWidth: 70}},
    highlightCallback: (event, x, points) => {
      for (const value of values) value.textContent = "";
      for (const {name, yval} of points) values[labels.indexOf(name)].textContent = us_label(yval);
    },
    unhighlightCallback: () => values.forEach((value) => { value.textContent = ""; }),
  });
}

// The cells of a histogram over time. More latencies make a cell darker.
function draw_cells({window_s, bins_per_octave, cells}, ctx, area, g) {
  const most = Math.log(1 + Math.max(...cells.map(([, , count]) => count)));
  const edge = (bin) => g.toDomYCoord(log_us(2 ** (bin / bins_per_octave)));
  ctx.save();
  ctx.beginPath();
  ctx.rect(area.x, area.y, area.w, area.h);
  ctx.clip();
  for (const [window, bin, count] of cells) {
    const left = g.toDomXCoord(window * window_s);
    const right = g.toDomXCoord((window + 1) * window_s);
    ctx.fillStyle = `rgba(0, 114, 178, ${0.12 + 0.88 * Math.log(1 + count) / most})`;
    ctx.fillRect(left, edge(bin + 1), Math.max(right - left, 1), edge(bin) - edge(bin + 1));
  }
  ctx.restore();
}

// The histogram of a stage over time, with the greatest latency of each window as a line.
function draw_over_time(parent, series) {
  const grid = series.over_time;
  const plot = make_plot(parent, series.name, "plot");
  plot.dataset.cells = grid.cells.length;
  const rows = grid.greatest_ns.map(
      (ns, window) => [(window + 0.5) * grid.window_s, ns === null ? null : log_us(ns)]);
  const bins = grid.cells.map(([, bin]) => bin);
  const low = log_us(2 ** (Math.min(...bins) / grid.bins_per_octave));
  const high = log_us(2 ** ((Math.max(...bins) + 1) / grid.bins_per_octave));
  return new Dygraph(plot, rows, {
    ...chart_options(["time", "greatest"], "time [s]"),
    colors: ["#D55E00"],
    strokeWidth: 1,
    dateWindow: [0, rows.length * grid.window_s],
    axes: {
      x: {ticker: (from, to, pixels) => ticks(from, to, pixels / 90), axisLabelWidth: 54},
      y: {ticker: us_ticks, axisLabelWidth: 70, valueRange: [low - 0.1, high + 0.1]},
    },
    underlayCallback: (ctx, area, g) => draw_cells(grid, ctx, area, g),
  });
}
