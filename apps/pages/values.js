// The data of the page, and the format of its values.

const report = JSON.parse(document.getElementById("data").textContent);

const kDerivatives = [
  {name: "position", per: ""},
  {name: "velocity", per: "/s"},
  {name: "acceleration", per: "/s²"},
  {name: "jerk", per: "/s³"},
];
const kLabelWidth = 70;     // px of an axis label
const kMarkSpacing = 7;     // px between marks that are drawn large
const kTickSpacing = 3;     // px between marks that are drawn small
const kPadding = 0.06;      // of the values' range, above and below
const kTimePadding = 0.01;  // of the duration, before and after
const kCoarse = 4;          // px per interval from which the page reports its coarse resolution
const kSharpSections = 16;  // most sections printed at double resolution; more need too much memory

const kAround = 0.25;       // s before and after an event that is chosen

const kSpanColors = {
  entry: "#dcebf7", stop: "#fbdcd2", hold: "#e3e3e3", slowed: "#f7eccb", missing: "#bdbdbd",
};

// `#draw=all` draws every chart at once; `&time=FROM,TO` zooms them, in seconds.
const address = new URLSearchParams(location.hash.slice(1));

const whole = report.duration > 0
    ? [-kTimePadding * report.duration, (1 + kTimePadding) * report.duration]
    : [-1.05, 1.05];

function unit_of(dimension, r) {
  const unit = dimension.unit || "unit";
  return (r > 0 && unit.includes("/") ? `(${unit})` : unit) + kDerivatives[r].per;
}

function axis_title(dimension, r) {
  return `${kDerivatives[r].name} [${unit_of(dimension, r)}]`;
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

// The least and greatest value that a chart shows between two times, waypoints included.
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
  report.missed_seconds.forEach((t, i) => {
    if (t >= from && t <= to) consider(dimension.missed[i]);
  });
  return [low, high];
}

// The range of values of a chart. Values that differ only by rounding give a flat line, not noise.
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
