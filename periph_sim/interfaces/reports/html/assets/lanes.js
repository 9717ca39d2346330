// Lanes of a timeline: one lane and a scale go in, SVG elements come out; and back, from a place to an event.
//
// A scale has from, to (ticks), left, right (pixels) and x(tick). A lane has the fields of Lane in html/timeline.py,
// its times summed up; `events` counts what one can walk through.

const CHARACTER = 6.1; // pixels
const HIGH = 14; // of a wave, a box, a mark
const NEAR = 8; // pixels within which an event is meant

/** An SVG element; text as text, never as markup. */
function svg(name, attributes = {}, text = "") {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text) element.textContent = text;
  return element;
}

function prepared(lane) {
  const at = summed(lane.at);
  const end = lane.long ? lane.long.map((long, i) => at[i] + long) : at;
  return { ...lane, at, end };
}

const drawLane = {
  wave(lane, scale, top) {
    const y = (level) => top + (level ? 0 : HIGH);
    let place = upTo(lane.at, scale.from);
    let level = lane.initial ^ (place & 1);
    let path = `M${scale.left} ${y(level)}`;
    let last = -Infinity;
    for (; place < lane.at.length && lane.at[place] <= scale.to; place += 1) {
      const x = scale.x(lane.at[place]);
      const next = lane.at[place + 1];
      if (x - last < 0.4 && next !== undefined && scale.x(next) - x < 0.4) {
        place += 1; // two edges within a pixel that is full already: the level is the same behind them
        continue;
      }
      path += `H${x.toFixed(2)}`;
      level ^= 1;
      path += `V${y(level)}`;
      last = x;
    }
    return [svg("path", { class: "wave", d: `${path}H${scale.right}` })];
  },

  boxes(lane, scale, top, says) {
    const drawn = [];
    let taken = -Infinity;
    for (let place = firstBox(lane, scale.from); place < lane.at.length && lane.at[place] <= scale.to; place += 1) {
      const begin = Math.max(scale.x(lane.at[place]), scale.left - 2);
      const width = Math.max(Math.min(scale.x(lane.end[place]), scale.right + 2) - begin, 1);
      if (width < 1.5 && begin - taken < 0.5) continue;
      taken = begin + width;
      const kind = lane.strong?.[place] ? " wrong" : "";
      drawn.push(svg("rect", { class: `box${kind}`, x: begin.toFixed(2), y: top, width: width.toFixed(2), height: HIGH, rx: 2 }));
      const from = Math.max(begin, scale.left);
      const room = Math.min(begin + width, scale.right) - from;
      const fits = (text) => text.length * CHARACTER + 4 <= room;
      const long = says[lane.labels[place]];
      // Of a wrong byte, a short text: what was received, with what was expected if there is room.
      const label = (kind ? [long, long.replaceAll("0x", ""), long.split(" ")[0]] : [long]).find(fits);
      if (label) {
        drawn.push(svg("text", { class: `label${kind}`, x: (from + room / 2).toFixed(1), y: top + HIGH - 3, "text-anchor": "middle" }, label));
      }
    }
    return drawn;
  },

  marks(lane, scale, top, says) {
    const drawn = [];
    let taken = -Infinity;
    let free = -Infinity;
    for (let place = upTo(lane.at, scale.from - 1); place < lane.at.length && lane.at[place] <= scale.to; place += 1) {
      const x = scale.x(lane.at[place]);
      const strong = lane.strong?.[place];
      if (x - taken < 1 && !strong) continue;
      taken = x;
      const shape = strong ? `M${(x - 4).toFixed(2)} ${top + 7}h8l-4 7z` : `M${(x - 3.5).toFixed(2)} ${top + 7.5}h7l-3.5 6z`;
      drawn.push(svg("path", { class: strong ? "mark strong" : "mark", d: shape }));
      const label = says[lane.labels[place]];
      const next = lane.at[place + 1];
      const room = (next === undefined ? scale.right : Math.min(scale.x(next), scale.right)) - x;
      if (x - 5 > free && room > label.length * CHARACTER + 12) {
        drawn.push(svg("text", { x: (x + 6).toFixed(1), y: top + HIGH - 1 }, label));
        free = x + 6 + label.length * CHARACTER;
      }
    }
    return drawn;
  },
};

/** The first box that is not over at a tick. */
function firstBox(lane, tick) {
  let place = upTo(lane.at, tick);
  while (place > 0 && lane.end[place - 1] >= tick) place -= 1;
  return place;
}

/** What is meant at a place: the event's number, or -1; of a wave between two edges the one before. */
function eventAt(lane, tick, near) {
  const after = upTo(lane.at, tick);
  const before = after - 1;
  const close = [before, after]
    .filter((place) => place >= 0 && place < lane.at.length && Math.abs(lane.at[place] - tick) <= near)
    .sort((a, b) => Math.abs(lane.at[a] - tick) - Math.abs(lane.at[b] - tick))[0];
  if (lane.kind === "boxes") {
    if (before >= 0 && lane.end[before] >= tick) return before;
    return close ?? -1;
  }
  return close ?? -1;
}

/** The instants of a lane to which a cursor may snap. */
function nearestInstant(lane, tick, near) {
  let best = null;
  for (const times of lane.kind === "boxes" ? [lane.at, lane.end] : [lane.at]) {
    const after = upTo(times, tick);
    for (const place of [after - 1, after]) {
      const there = times[place];
      if (there === undefined || Math.abs(there - tick) > near) continue;
      if (best === null || Math.abs(there - tick) < Math.abs(best - tick)) best = there;
    }
  }
  return best;
}

/** Whether anything begins, ends or changes between two ticks. */
function moves(lane, from, to) {
  return [lane.at, lane.end].some((times) => upTo(times, to) > upTo(times, from - 1));
}
