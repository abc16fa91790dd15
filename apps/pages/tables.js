// The table of a dimension.

// The cells of a value and its time. Shows a magnitude of at most `rounding` as ≈ 0.
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
      (with_distance ? "; distance: the largest distance from a waypoint" : "") +
      ". ≈ 0: within rounding errors.");
  const head = element(element(table, "thead"), "tr");
  const titles = ["curve", "quantity", "least", "at [s]", "greatest", "at [s]", "step", "at [s]"];
  if (with_distance) titles.push("distance", "at [s]");
  for (const title of titles) element(head, "th", title);
  report.curves.forEach((_, c) => {
    make_rows(element(table, "tbody"), dimension, c, with_distance);
  });
}
