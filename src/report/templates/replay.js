
// --- playing ---------------------------------------------------------------------------------------------

const panels = trials.map(panelOf);
const scrub = element("scrub"), speed = element("speed");

function draw() {
  panels.forEach(drawPanel);
  drawChart();
  scrub.value = Math.round(now * 1000);
  const text = `${now.toFixed(1)} of ${end.toFixed(1)} s`;
  element("clock").textContent = text;
  scrub.setAttribute("aria-valuetext", text);
}

function seek(instant) {
  now = Math.max(0, Math.min(end, instant));
  draw();
}

function play(on) {
  playing = on && end > 0;
  element("play").textContent = playing ? "❚❚ pause" : "▶ play";
  if (!playing) return;
  if (now >= end) now = 0;
  last = performance.now();
  requestAnimationFrame(tick);
}

function tick(stamp) {
  if (!playing) return;
  const passed = Math.max(0, stamp - last) / 1000;
  last = stamp;
  seek(now + passed * Number(speed.value));
  if (now >= end) play(false); else requestAnimationFrame(tick);
}

// To the neighbour of the present instant in an ascending list.
function step(list, forth) {
  play(false);
  const at = lastAt(list.length, (i) => list[i], now + (forth ? 1e-6 : -1e-6));
  seek(list[Math.max(0, Math.min(list.length - 1, at + (forth ? 1 : 0)))] ?? 0);
}

element("play").addEventListener("click", () => play(!playing));
element("back").addEventListener("click", () => step(instants, false));
element("forth").addEventListener("click", () => step(instants, true));
element("before").addEventListener("click", () => step(decisions, false));
element("after").addEventListener("click", () => step(decisions, true));
scrub.addEventListener("input", () => seek(scrub.value / 1000));
chart.addEventListener("pointerdown", (event) => {
  const part = (event.offsetX - inset.left) / (chart.clientWidth - inset.left - inset.right);
  seek(part * end);
});
for (const box of document.querySelectorAll("[data-layer]")) box.addEventListener("change", draw);

window.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.tagName === "SELECT") return;
  const pressable = event.target.tagName === "BUTTON" || event.target.type === "checkbox";
  const faster = (by) => (speed.selectedIndex = Math.max(0, Math.min(speed.length - 1, speed.selectedIndex + by)));
  const lists = event.shiftKey ? decisions : instants;
  const actions = {
    " ": pressable ? null : () => play(!playing),
    ArrowLeft: () => step(lists, false), ArrowRight: () => step(lists, true),
    Home: () => seek(0), End: () => seek(end),
    "+": () => faster(1), "-": () => faster(-1),
  };
  if (!actions[event.key]) return;
  event.preventDefault();
  actions[event.key]();
});

function restyle() {
  readColours();
  for (const panel of panels) {
    panel.stale = true;
    paintPrior(panel);
  }
  draw();
}

scrub.max = Math.round(end * 1000);
element("trials").classList.toggle("one", trials.length === 1);
element("prior-toggle").hidden = !trials.some((trial) => trial.prior);
element("graph-toggle").hidden = !racing;
for (const layer of ["map", "scan", "frontiers"]) {
  document.querySelector(`[data-layer=${layer}]`).parentElement.hidden = !mapping;
}
const charted = racing ? "vertices known" : mapping ? "coverage" : "distance travelled";
element("chart-title").textContent = charted;
chart.setAttribute("aria-label", `${charted[0].toUpperCase()}${charted.slice(1)} over time, of every trial`);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", restyle);
window.addEventListener("resize", draw);
window.addEventListener("hashchange", () => seek(fromAddress()));
const fromAddress = () => Number(/t=([\d.]+)/.exec(location.hash)?.[1] ?? 0);
now = Math.min(end, fromAddress());
restyle();
