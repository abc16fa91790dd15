// Tests append this to a latency report page: it writes what the page shows, as JSON, into its DOM.
const texts = (query) => [...document.querySelectorAll(query)].map((found) => found.textContent);

const facts = {
  warnings: texts("#warnings li"),
  notes: texts("#notes p"),
  stages: texts("main .scroll:first-of-type tbody th:first-child"),
  few: texts("td.few").length,
  foreign: document.querySelectorAll("b, img").length,
  plots: [...document.querySelectorAll(".plot")].map((plot) => ({
    name: plot.dataset.name,
    canvases: plot.querySelectorAll("canvas").length,
    ticks: [...plot.querySelectorAll(".dygraph-axis-label-y")].length,
    shares: [...plot.querySelectorAll(".dygraph-axis-label-x")].map((tick) => tick.textContent),
    series: Number(plot.dataset.series || 0),
    cells: Number(plot.dataset.cells || 0),
  })),
};
const written = document.createElement("pre");
written.textContent = "FACTS" +
    JSON.stringify(facts).replace(/[<>&]/g, (c) => "\\u00" + c.charCodeAt(0).toString(16)) + "FACTS";
document.body.append(written);
