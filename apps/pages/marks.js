// Marks on the charts: knots, waypoints, parts of the time, events, limits and the crosshair.

// The visible ones of `times`, as [time, index], and whether there is room for large marks.
function seen(times, area, g) {
  const [from, to] = g.xAxisRange();
  const marks = times.map((t, i) => [t, i]).filter(([t]) => t >= from && t <= to);
  return {marks, large: marks.length * kMarkSpacing <= area.w};
}

// Lines at the knots, under the curves; without room, ticks at the bottom for every 2nd, 4th, … knot.
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

// Bands under the curves: the parts of the time that are not the spline through the waypoints.
function draw_spans(ctx, area, g) {
  for (const {kind, from, to} of report.spans) {
    const left = Math.max(area.x, g.toDomXCoord(from));
    const right = Math.min(area.x + area.w, Math.max(g.toDomXCoord(to), g.toDomXCoord(from) + 1));
    if (right <= left) continue;
    ctx.fillStyle = kSpanColors[kind];
    ctx.fillRect(left, area.y, right - left, area.h);
  }
}

function draw_lines(ctx, lines, style, dash) {
  ctx.save();
  ctx.strokeStyle = style;
  ctx.setLineDash(dash);
  ctx.lineWidth = 1;
  ctx.beginPath();
  for (const [x0, y0, x1, y1] of lines) {
    ctx.moveTo(x0, y0);
    ctx.lineTo(x1, y1);
  }
  ctx.stroke();
  ctx.restore();
}

function draw_limits(chart, ctx, area, g) {
  const inside = (y) => y >= area.y && y <= area.y + area.h;
  const lines = chart.dimension.limits[chart.r].filter((value) => value !== null)
      .map((value) => Math.round(g.toDomYCoord(value)) + 0.5).filter(inside)
      .map((y) => [area.x, y, area.x + area.w, y]);
  draw_lines(ctx, lines, "#c00000", [2, 3]);
  chart.plot.dataset.limits = lines.length;
}

function draw_events(chart, ctx, area, g) {
  const {marks} = seen(report.marks.map(({at}) => at), area, g);
  const lines = marks.map(([t]) => Math.round(g.toDomXCoord(t)) + 0.5)
      .map((x) => [x, area.y, x, area.y + area.h]);
  draw_lines(ctx, lines, "#7b3294", [6, 3]);
  chart.plot.dataset.marks = lines.length;
}

// Crosses at the waypoints that the curve does not meet.
function draw_missed(chart, ctx, area, g) {
  const {marks} = seen(report.missed_seconds, area, g);
  const lines = [];
  for (const [t, i] of marks) {
    const [x, y] = [g.toDomXCoord(t), g.toDomYCoord(chart.dimension.missed[i])];
    if (y < area.y || y > area.y + area.h) continue;
    lines.push([x - 3, y - 3, x + 3, y + 3], [x - 3, y + 3, x + 3, y - 3]);
  }
  draw_lines(ctx, lines, "#c00000", []);
  chart.plot.dataset.missed = marks.length;
}

function draw_circles(chart, marks, ctx, g, radius) {
  for (const [t, i] of marks) {
    ctx.beginPath();
    ctx.arc(g.toDomXCoord(t), g.toDomYCoord(chart.dimension.waypoints[i]), radius, 0, 2 * Math.PI);
    ctx.fill();
    if (ctx.strokeStyle !== ctx.fillStyle) ctx.stroke();
  }
}

// Rings at the waypoints, over the curves; without room, dots under the curves.
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

// The plugin of dygraphs that draws the marks of a chart.
function marks(chart) {
  return {
    activate: () => ({
      willDrawChart: ({drawingContext, dygraph}) => {
        const area = dygraph.getArea();
        draw_spans(drawingContext, area, dygraph);
        draw_limits(chart, drawingContext, area, dygraph);
        draw_events(chart, drawingContext, area, dygraph);
        if (chart.r > 0) draw_knots(chart, drawingContext, area, dygraph);
        else draw_waypoints(chart, drawingContext, area, dygraph, false);
      },
      didDrawChart: ({drawingContext, dygraph}) => {
        if (chart.r > 0) return;
        draw_waypoints(chart, drawingContext, dygraph.getArea(), dygraph, true);
        draw_missed(chart, drawingContext, dygraph.getArea(), dygraph);
      },
      select: (e) => draw_crosshair(e.dygraph, e.dygraph.toDomXCoord(e.selectedX)),
    }),
  };
}
