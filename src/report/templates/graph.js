
// --- the deadline study: the graph as the robot knows it, its leg, its policy, the clock -----------------

function drawArrow({ context, at }, from, to, width) {
  const [x0, y0] = at(from), [x1, y1] = at(to), length = Math.hypot(x1 - x0, y1 - y0) || 1;
  const [u, v] = [(x1 - x0) / length, (y1 - y0) / length], head = 6 + 2 * width;
  // Beside the edge, so that both directions of it can be told apart, and short of the vertices.
  const [a, b] = [[x0 + u * 9 - v * 4, y0 + v * 9 + u * 4], [x1 - u * 9 - v * 4, y1 - v * 9 + u * 4]];
  context.lineWidth = width;
  trace(context, [a, b], (p) => p, false);
  context.stroke();
  context.beginPath();
  context.moveTo(...b);
  context.lineTo(b[0] - u * head - v * head / 2, b[1] - v * head + u * head / 2);
  context.lineTo(b[0] - u * head + v * head / 2, b[1] - v * head - u * head / 2);
  context.closePath();
  context.fill();
}

function drawGraph(view, graph) {
  const { context, at } = view, place = (v) => graph.vertices[v].at;
  const spot = ({ x, y }) => at([x, y]);
  context.strokeStyle = colour.trail;
  context.lineWidth = 2;
  for (const [a, b] of graph.edges) {
    trace(context, [place(a), place(b)], spot, false);
    context.stroke();
  }
  context.strokeStyle = colour.frontier;
  context.setLineDash([2, 3]);
  for (const { at: from, unexplored } of graph.vertices) {
    for (const heading of unexplored) {
      const to = { x: from.x + Math.cos(heading), y: from.y + Math.sin(heading) };
      trace(context, [from, to], spot, false);
      context.stroke();
    }
  }
  context.setLineDash([]);
  const pair = ({ x, y }) => [x, y];
  for (const { from, to, probability, fast } of graph.policy) {
    context.strokeStyle = context.fillStyle = colour.path;
    context.globalAlpha = 0.25 + 0.75 * probability;
    drawArrow(view, pair(place(from)), pair(place(to)), fast ? 3.5 : 1.5);
    context.globalAlpha = 1;
  }
  const told = [];
  graph.vertices.forEach((vertex, i) => {
    const [x, y] = spot(vertex.at), target = i === graph.target;
    context.beginPath();
    if (vertex.room) context.rect(x - 5, y - 5, 10, 10); else context.arc(x, y, 5, 0, 2 * Math.PI);
    context.fillStyle = target ? colour.chosen : vertex.goal ? colour.frontier : colour.card;
    context.strokeStyle = colour.ink;
    context.lineWidth = i === graph.current ? 3.5 : 1.5;
    context.fill();
    context.stroke();
    const label = [vertex.label + (target ? " ◆" : "") + (vertex.goal ? " goal" : ""), x, y, 6];
    if (target || vertex.goal || i === graph.current) told.unshift(label); else told.push(label);
  });
  for (const label of told) beside(view, ...label);
}

// Clock against deadline, and what the robot is about.
function graphStatus(trial, graph, time) {
  const left = trial.deadline - time;
  let text = `${left.toFixed(0)} s left of ${trial.deadline.toFixed(0)} s`;
  if (!graph) return text;
  text += ` · ${graph.vertices.length} vertices known · ${graph.doing}`;
  if (graph.target !== null && graph["leg-deadline-s"] !== null) {
    const leg = graph["leg-deadline-s"] - time;
    const within = leg >= 0 ? `within ${leg.toFixed(1)} s` : `${(-leg).toFixed(1)} s over its time`;
    text += ` · leg to ${graph.vertices[graph.target].label}, ${within}`;
  }
  return text;
}

// What the target was chosen among, and by which rule.
function candidateRows(trial, [, graph]) {
  if (!graph.candidates.length) return [];
  const because = trial.rule ? `why: ${trial.rule}` : "chosen among";
  const rows = [make("caption", "", because), row(["vertex", "unexplored edges", "edges away"], "th")];
  const chosen = ({ vertex }) => vertex === graph.target;
  const ordered = [...graph.candidates].sort((a, b) => chosen(b) - chosen(a)
    || b.unexplored - a.unexplored || a["edges-away"] - b["edges-away"]);
  for (const candidate of ordered.slice(0, 8)) {
    const name = (chosen(candidate) ? "◆ " : "") + graph.vertices[candidate.vertex].label;
    const cells = [name, candidate.unexplored, candidate["edges-away"]];
    rows.push(row(cells, "td", chosen(candidate) ? "chosen" : ""));
  }
  const more = graph.candidates.length - 8;
  if (more > 0) rows.push(row([`and ${more} more`, "", ""], "td", "soft"));
  return rows;
}

function policyRows(trial, [at, graph]) {
  const when = `at ${trial.time[at].toFixed(1)} s`;
  if (!graph.policy.length) return [make("caption", "", `${when}: no plan is followed`)];
  const label = (v) => graph.vertices[v].label;
  const rows = [make("caption", "", `policy ${when}: at, to, how, probability`), row(["at", "to", "how", "p"], "th")];
  for (const { from, to, probability, fast } of graph.policy.slice(0, 12)) {
    rows.push(row([label(from), label(to), fast ? "fast" : "slow", probability.toFixed(2)], "td"));
  }
  const more = graph.policy.length - 12;
  if (more > 0) rows.push(row(["", `and ${more} more`, "", ""], "td"));
  return rows;
}
