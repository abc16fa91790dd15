// Constants and functions of all pages.

// Colours of Okabe and Ito without yellow, which is hard to see on white. Black is for waypoints.
const kColors = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#666666"];
// The first curve is solid, so that it shows in the gaps of a dashed curve on top of it.
const kDashes = [[], [8, 4], [3, 3], [10, 3, 3, 3], [14, 5]];

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

const color_of = (c) => kColors[c % kColors.length];
const dash_of = (c) => kDashes[c % kDashes.length];

// Ticks at multiples of 1, 2 or 5 times a power of ten, with enough digits to distinguish them.
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
