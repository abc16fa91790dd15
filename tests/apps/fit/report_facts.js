// Tests append this to a report page: it writes what the page shows and does, as JSON, into its DOM.
const texts = (node, query) => [...node.querySelectorAll(query)].map((found) => found.textContent);

function facts_of_chart(chart) {
  const plot = chart.querySelector(".plot");
  return {
    canvases: plot.querySelectorAll("canvas").length,
    titles: texts(plot, ".dygraph-ylabel, .dygraph-xlabel"),
    ticks: texts(plot, ".dygraph-axis-label-y"),
    legend: texts(chart, ".legend .name"),
    values: texts(chart, ".legend .value"),
    times: plot.dataset.times.split(" ").map(Number),
    range: plot.dataset.range.split(" ").map(Number),
    waypoints: Number(plot.dataset.waypoints || 0),
    knots: Number(plot.dataset.knots || 0),
  };
}

function facts_of_section(section) {
  return {
    heading: section.querySelector("h2").textContent,
    coarse: !section.querySelector(".coarse").hidden,
    charts: [...section.querySelectorAll(".chart")].map(facts_of_chart),
    table: [...section.querySelectorAll("tbody tr")].map((row) => ({
      texts: texts(row, "th, td"),
      values: [...row.querySelectorAll("td[data-value]")].map((cell) => Number(cell.dataset.value)),
    })),
  };
}

function note() {
  notes.push({
    title: document.title,
    heading: document.querySelector("h1").textContent,
    summary: texts(document, "#summary dd"),
    notes: texts(document, "#notes p"),
    foreign: document.querySelectorAll("b, img").length,
    sections: [...document.querySelectorAll("section")].map(facts_of_section),
  });
}

// A mouse event on the r-th chart of the first dimension, at a fraction of its width.
function mouse(type, r, fraction) {
  const box = document.querySelectorAll(".plot")[r].getBoundingClientRect();
  const place = {
    bubbles: true,
    clientX: box.left + fraction * box.width,
    clientY: box.top + 0.4 * box.height,
  };
  document.elementFromPoint(place.clientX, place.clientY).dispatchEvent(new MouseEvent(type, place));
}

const notes = [];
note();
mouse("mousemove", 2, 0.5);
note();
mouse("mousedown", 1, 0.4);
mouse("mousemove", 1, 0.6);
mouse("mouseup", 1, 0.6);
note();
mouse("dblclick", 3, 0.5);
note();
const written = document.createElement("pre");
written.textContent = "FACTS" +
    JSON.stringify(notes).replace(/[<>&]/g, (c) => "\\u00" + c.charCodeAt(0).toString(16)) + "FACTS";
document.body.append(written);
