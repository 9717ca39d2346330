// The timelines of the page: zoom, pan, hover, walk by keyboard, measure between two cursors.

const ROW = 24;
const HEAD = 20; // of a group
const TOP = 26; // axis
const EDGE = 12; // at the right
const LEAST = 20e-9; // seconds in view

class Timeline {
  constructor(figure) {
    this.figure = figure;
    this.svg = figure.querySelector(".stage > svg");
    this.tip = figure.querySelector(".tip");
    this.range = figure.querySelector(".range");
    this.texts = [...figure.querySelectorAll("script")].map((script) => script.textContent);
    this.caption = figure.querySelector("figcaption").textContent;
    this.off = new Set(); // names of groups that are put away
    this.all = false; // whether lanes that the explanation is not about are drawn, too
    this.viewers = [new Minimap(this), ...(figure.querySelector(".protocol") ? [new Protocol(this)] : [])];
    this.listen();
    this.load(0);
    new ResizeObserver(() => this.draw()).observe(this.svg.parentElement);
  }

  /** Show another occurrence: 0 is the worst. */
  load(number, caption = this.caption) {
    this.number = number;
    this.data = JSON.parse(this.texts[number]);
    this.origin = BigInt(this.data.origin);
    this.units = Object.keys(this.data.cycles);
    this.groups = this.data.groups.map(({ name, lanes }) => ({ name, tone: name.split(" ").pop(), lanes: lanes.map(prepared) }));
    const lanes = this.groups.flatMap((group) => group.lanes);
    if (!lanes.some((lane) => lane.chosen)) for (const lane of lanes) lane.chosen = moves(lane, ...this.data.shown);
    this.cursors = { a: null, b: null };
    this.chosen = null; // { lane, event, tick } that the keyboard stands on; around: where it looks in other lanes
    [this.from, this.to] = this.data.shown;
    this.figure.querySelector("figcaption").textContent = caption;
    this.hide();
    this.chips();
    for (const viewer of this.viewers) viewer.load();
    this.draw();
  }

  lanesOf(group) { return group.lanes.filter((lane) => this.all || lane.chosen); }

  get first() { return this.data.kept[0][0]; }
  get last() { return this.data.kept.at(-1)[1]; }

  perCycle(lane) { return this.data.cycles[lane?.unit] ?? this.data.cycles[this.units[0]]; }

  // View ---------------------------------------------------------------------------

  show(from, to) {
    const most = this.last - this.first;
    const length = Math.min(Math.max(to - from, LEAST * this.data.perSecond), most);
    const middle = (from + to) / 2;
    this.from = Math.min(Math.max(middle - length / 2, this.first), this.last - length);
    this.to = this.from + length;
    this.draw();
  }

  zoom(factor, around = (this.from + this.to) / 2) {
    const part = (around - this.from) / (this.to - this.from);
    const length = Math.min((this.to - this.from) * factor, this.last - this.first);
    this.show(around - part * length, around + (1 - part) * length);
  }

  pan(part) {
    const by = part * (this.to - this.from);
    this.show(this.from + by, this.to + by);
  }

  scale() {
    const width = Math.max(this.svg.parentElement.clientWidth, 240);
    const left = width < 560 ? 84 : 150;
    const right = width - EDGE;
    const { from, to } = this;
    return { width, left, right, from, to, x: (tick) => left + ((tick - from) / (to - from)) * (right - left) };
  }

  // Drawing --------------------------------------------------------------------------

  draw() {
    const scale = this.scale();
    this.rows = [];
    const parts = [];
    let y = TOP;
    for (const group of this.groups) {
      const lanes = this.off.has(group.name) ? [] : this.lanesOf(group);
      if (!lanes.length) continue;
      parts.push(svg("text", { class: "group", x: 4, y: y + 14 }, group.name));
      y += HEAD;
      for (const lane of lanes) {
        this.rows.push({ lane, top: y });
        parts.push(this.lane(lane, group, scale, y));
        y += ROW;
      }
    }
    const height = y + 8;
    const clip = `${this.figure.id}-clip`;
    const clipPath = svg("clipPath", { id: clip });
    clipPath.append(svg("rect", { x: scale.left, y: 0, width: scale.right - scale.left, height }));
    const field = svg("g", { "clip-path": `url(#${clip})` });
    const [grid, axis] = this.axis(scale, height);
    field.append(...this.holes(scale, height), this.occurrence(scale, height), ...grid);
    this.svg.setAttribute("viewBox", `0 0 ${scale.width} ${height}`);
    this.svg.replaceChildren(clipPath, field, ...axis, ...parts, ...this.lines(scale, height));
    this.svg.style.height = `${height}px`;
    this.tell();
    for (const viewer of this.viewers) viewer.view();
  }

  lane(lane, group, scale, y) {
    const row = svg("g", { class: `lane tone-${group.tone}` });
    const chosen = this.chosen?.lane === lane;
    if (chosen) row.append(svg("rect", { class: "chosen", x: 0, y: y - 3, width: scale.width, height: ROW - 2, rx: 3 }));
    const room = Math.floor((scale.left - 8) / 6.3);
    const short = lane.name.length > room ? lane.name.split(".").pop() : lane.name;
    const name = svg("text", { class: "name", x: scale.left - 8, y: y + 12, "text-anchor": "end" }, short.slice(0, room));
    name.append(svg("title", {}, lane.name));
    const inside = svg("g", { "clip-path": `url(#${this.figure.id}-clip)` });
    inside.append(...drawLane[lane.kind](lane, scale, y + 1, this.data.says));
    row.append(name, inside);
    return row;
  }

  axis(scale, height) {
    const perSecond = this.data.perSecond;
    const steps = Math.max(4, Math.floor((scale.right - scale.left) / 100));
    const [unit, factor] = UNITS.find(([, each]) => ((this.to - this.from) / perSecond) * each < 2000) ?? UNITS[3];
    const step = niceStep(((this.to - this.from) / perSecond) * factor, steps);
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const lines = [];
    const texts = [];
    for (let n = Math.ceil(((this.from / perSecond) * factor) / step); ; n += 1) {
      const tick = ((n * step) / factor) * perSecond;
      if (tick > this.to) break;
      const x = scale.x(tick).toFixed(1);
      const anchor = x > scale.right - 24 ? "end" : "middle";
      lines.push(svg("line", { class: "grid", x1: x, x2: x, y1: TOP - 6, y2: height }));
      texts.push(svg("text", { class: "axis", x, y: 13, "text-anchor": anchor }, `${(n * step).toFixed(decimals)} ${unit}`));
    }
    return [lines, texts];
  }

  occurrence(scale, height) {
    const begin = scale.x(this.data.begin);
    const width = Math.max(scale.x(this.data.end) - begin, 1.5);
    return svg("rect", { class: "occurrence", x: begin.toFixed(2), y: TOP - 6, width: width.toFixed(2), height });
  }

  /** What was not kept between two ranges. */
  holes(scale, height) {
    return this.data.kept.slice(1).map(([begin], i) => {
      const x = scale.x(this.data.kept[i][1]);
      return svg("rect", { class: "hole", x, y: TOP - 6, width: scale.x(begin) - x, height });
    });
  }

  lines(scale, height) {
    const drawn = [];
    for (const [name, tick] of Object.entries(this.cursors)) {
      if (tick === null || tick < this.from || tick > this.to) continue;
      const x = scale.x(tick).toFixed(2);
      drawn.push(svg("line", { class: "cursor", x1: x, x2: x, y1: TOP - 8, y2: height }));
      drawn.push(svg("text", { class: "cursor", x: Number(x) + 4, y: TOP + 4 }, name.toUpperCase()));
    }
    return drawn;
  }

  /** The line below: what is in view, and what lies between the cursors. */
  tell() {
    const { perSecond } = this.data;
    const length = lengthText(this.to - this.from, perSecond);
    const parts = [`${instantText(this.origin, this.from, perSecond)} to ${instantText(this.origin, this.to, perSecond)}, ${length}`];
    const { a, b } = this.cursors;
    for (const [name, tick] of [["A", a], ["B", b]]) {
      if (tick !== null) parts.push(`${name} ${instantText(this.origin, tick, perSecond)} (${lengthText(tick, perSecond)})`);
    }
    if (a !== null && b !== null) {
      const rate = a === b ? "" : `, ${(perSecond / Math.abs(b - a) / 1e3).toFixed(3)} kHz`;
      parts.push(`B - A ${lengthText(b - a, perSecond)} (${cyclesText(b - a, this.perCycle())}${rate})`);
    }
    this.range.replaceChildren(...parts.map((part) => Object.assign(document.createElement("span"), { textContent: part })));
  }

  /** Switches for the groups that have lanes to be drawn, and one for all lanes. */
  chips() {
    const button = (text, pressed, act) => {
      const one = Object.assign(document.createElement("button"), { type: "button", textContent: text });
      one.setAttribute("aria-pressed", pressed);
      one.addEventListener("click", () => {
        act();
        this.chips();
        this.draw();
      });
      return one;
    };
    const more = this.groups.flatMap((group) => group.lanes).filter((lane) => !lane.chosen).length;
    const groups = this.groups.filter((group) => this.lanesOf(group).length);
    const chips = groups.map(({ name }) => button(name, !this.off.has(name), () => this.off.delete(name) || this.off.add(name)));
    if (more) chips.push(button(`all lanes (${more} more)`, this.all, () => (this.all = !this.all)));
    this.figure.querySelector(".groups").replaceChildren(...chips);
  }

  // Looking at events ----------------------------------------------------------------

  tickAt(x) {
    const scale = this.scale();
    return this.from + ((x - scale.left) / (scale.right - scale.left)) * (this.to - this.from);
  }

  near() {
    const scale = this.scale();
    return (NEAR / (scale.right - scale.left)) * (this.to - this.from);
  }

  /** Place within the drawing of a pointer event. */
  place(event) {
    const box = this.svg.getBoundingClientRect();
    const x = event.clientX - box.left;
    const y = event.clientY - box.top;
    return { x, y, row: this.rows.find((row) => y >= row.top - 4 && y < row.top + ROW - 4) };
  }

  /** Cursor A at a tick, which comes into view. */
  go(tick) {
    const half = (this.to - this.from) / 2;
    if (tick < this.from || tick > this.to) this.show(tick - half, tick + half);
    this.setCursor("a", tick);
  }

  // Cursors ---------------------------------------------------------------------------

  setCursor(name, tick) {
    this.cursors[name] = Math.round(tick);
    this.draw();
  }

  /** A click: at the nearest event of the lane; first A, then B, then whichever is nearer. */
  click(event) {
    const { x, row } = this.place(event);
    if (x < this.scale().left) return;
    const tick = this.tickAt(x);
    const there = (row && nearestInstant(row.lane, tick, this.near())) ?? tick;
    const { a, b } = this.cursors;
    const name = a === null ? "a" : b === null ? "b" : Math.abs(tick - a) < Math.abs(tick - b) ? "a" : "b";
    this.setCursor(name, there);
  }

  clear() {
    this.cursors = { a: null, b: null };
    this.draw();
  }

  // Keyboard --------------------------------------------------------------------------

  /** To the event before or behind (by -1, 1), or the lane above or below. */
  walk(by) {
    if (!this.chosen || !this.rows.some((row) => row.lane === this.chosen.lane)) {
      this.choose(this.rows[0].lane, (this.from + this.to) / 2);
    } else {
      const { lane } = this.chosen;
      const event = Math.min(Math.max(this.chosen.event + by, 0), lane.at.length - 1);
      this.choose(lane, lane.at[event], event);
    }
  }

  walkLane(by) {
    const now = this.rows.findIndex((row) => row.lane === this.chosen?.lane);
    const row = this.rows[Math.min(Math.max(now + by, 0), this.rows.length - 1)];
    this.choose(row.lane, this.chosen?.around ?? (this.from + this.to) / 2);
  }

  choose(lane, tick, event = null) {
    const after = upTo(lane.at, tick);
    const nearer = after > 0 && (after === lane.at.length || tick - lane.at[after - 1] <= lane.at[after] - tick);
    const place = event ?? (nearer ? after - 1 : after);
    if (!lane.at.length) return;
    const at = lane.at[place];
    this.chosen = { lane, event: place, tick: at, around: event === null ? tick : at };
    if (at < this.from || at > this.to) {
      const half = (this.to - this.from) / 2;
      this.show(at - half, at + half);
    } else {
      this.draw();
    }
    const row = this.rows.find((one) => one.lane === lane);
    this.explain(lane, place, this.scale().x(at), row.top);
  }

  /** What is chosen or, where nothing is, the middle of the view. */
  get here() { return this.chosen?.tick ?? (this.from + this.to) / 2; }

  escape() {
    if (!this.tip.hidden || this.chosen) {
      this.chosen = null;
      this.hide();
      this.draw();
    } else {
      this.clear();
    }
  }

  // Listening -------------------------------------------------------------------------

  listen() {
    const acts = {
      in: () => this.zoom(0.5, this.here),
      out: () => this.zoom(2, this.here),
      left: () => this.pan(-0.25),
      right: () => this.pan(0.25),
      reset: () => this.show(...this.data.shown),
      everything: () => this.show(this.first, this.last),
      a: () => this.setCursor("a", this.here),
      b: () => this.setCursor("b", this.here),
      clear: () => this.clear(),
    };
    for (const button of this.figure.querySelectorAll("[data-do]")) {
      button.addEventListener("click", acts[button.dataset.do]);
    }
    const keys = {
      "+": acts.in, "=": acts.in, "-": acts.out, 0: acts.reset, Home: acts.reset, 9: acts.everything, a: acts.a, b: acts.b,
      ArrowLeft: (event) => (event.shiftKey ? acts.left() : this.walk(-1)),
      ArrowRight: (event) => (event.shiftKey ? acts.right() : this.walk(1)),
      ArrowUp: () => this.walkLane(-1),
      ArrowDown: () => this.walkLane(1),
      Escape: () => this.escape(),
    };
    this.svg.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || !(event.key in keys)) return;
      event.preventDefault();
      keys[event.key](event);
    });
    for (const button of this.figure.closest(".budget").querySelectorAll("[data-go]")) {
      button.addEventListener("click", () => {
        if (this.number) this.load(0); // steps are those of the worst
        this.go(Number(button.dataset.go));
      });
    }
    this.svg.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    this.svg.addEventListener("pointerdown", (event) => this.press(event));
    this.svg.addEventListener("pointermove", (event) => this.move(event));
    this.svg.addEventListener("pointerup", (event) => this.release(event));
    this.svg.addEventListener("pointercancel", () => (this.pressed = null));
    this.svg.addEventListener("pointerleave", () => this.hide());
  }

  wheel(event) {
    if (!event.ctrlKey && document.activeElement !== this.svg) return; // the page scrolls
    event.preventDefault();
    this.zoom(event.deltaY < 0 ? 0.8 : 1.25, this.tickAt(this.place(event).x));
  }

  press(event) {
    if (event.button !== 0) return;
    this.svg.setPointerCapture(event.pointerId);
    this.pressed = { x: event.clientX, from: this.from, to: this.to, moved: false };
  }

  move(event) {
    if (!this.pressed) return this.hover(event);
    const by = event.clientX - this.pressed.x;
    if (Math.abs(by) > 3) this.pressed.moved = true;
    if (!this.pressed.moved) return;
    this.hide();
    const scale = this.scale();
    const ticks = (by / (scale.right - scale.left)) * (this.pressed.to - this.pressed.from);
    this.show(this.pressed.from - ticks, this.pressed.to - ticks);
  }

  release(event) {
    if (this.pressed && !this.pressed.moved) this.click(event);
    this.pressed = null;
  }
}

Object.assign(Timeline.prototype, eventTexts);
