"use strict";

// Base64 text of zigzag variable-length integers, as `src/report/pack.rs` writes them.
function integers(text) {
  const bytes = atob(text);
  const values = [];
  let value = 0, factor = 1;
  for (let i = 0; i < bytes.length; i++) {
    const byte = bytes.charCodeAt(i);
    value += (byte & 127) * factor;
    factor *= 128;
    if (byte < 128) {
      values.push(value % 2 ? -(value + 1) / 2 : value / 2);
      value = 0;
      factor = 1;
    }
  }
  return values;
}

// Differences, summed up and scaled.
function column(text, unit = 0.001) {
  let sum = 0;
  return integers(text).map((step) => (sum += step) * unit);
}

// Points as [x, y], from differences.
function points(text, unit = 0.001) {
  const steps = integers(text), list = [];
  let x = 0, y = 0;
  for (let i = 0; i + 1 < steps.length; i += 2) {
    x += steps[i];
    y += steps[i + 1];
    list.push([x * unit, y * unit]);
  }
  return list;
}

// Writes runs of changed cells into `cells`: 0 unknown, 1 free, 2 occupied. Returns the first and the last one.
function applyRuns(text, cells) {
  const values = integers(text);
  let at = 0, first = Infinity, last = -1;
  for (let kind = 0; kind < 3; kind++) {
    let index = 0;
    for (let left = values[at++] || 0; left > 0; left--) {
      index += values[at++];
      cells.fill(kind, index, index + values[at]);
      first = Math.min(first, index);
      index += values[at++];
      last = Math.max(last, index - 1);
    }
  }
  return [first, last];
}

function unpackTrial(packed) {
  const trial = { ...packed };
  for (const name of ["time", "x", "y", "heading", "distance", "coverage"]) trial[name] = column(packed[name]);
  trial.polygons = packed.polygons.map((text) => points(text));
  trial.scans = packed.scans.map(([at, text]) => [at, points(text, 0.01)]);
  trial.paths = packed.paths.map(([at, text]) => [at, points(text)]);
  trial.footprint = packed.footprint.polygon
    ? { corners: points(packed.footprint.polygon) }
    : { disc: packed.footprint.disc };
  for (const [, decision] of trial.decisions) {
    for (const frontier of decision.frontiers) frontier.cells = points(frontier.cells, 0.01);
    // Rank by utility, best first; equal ones as they were found.
    decision.ranked = decision.frontiers.map((_, i) => i);
    decision.ranked.sort((a, b) => decision.frontiers[b].utility - decision.frontiers[a].utility || a - b);
    decision.ranked.forEach((i, rank) => (decision.frontiers[i].rank = rank + 1));
  }
  return trial;
}
