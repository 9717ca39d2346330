// What a timeline says of an event beside it: mixed into Timeline.

const eventTexts = {
  hover(event) {
    const { x, y, row } = this.place(event);
    if (!row || x < this.scale().left) return this.hide();
    const tick = this.tickAt(x);
    const found = eventAt(row.lane, tick, this.near());
    if (found >= 0) return this.explain(row.lane, found, x, y);
    if (row.lane.kind === "wave") return this.explainLevel(row.lane, tick, x, y);
    return this.hide();
  },

  explain(lane, event, x, y) {
    const { perSecond, says } = this.data;
    const at = lane.at[event];
    const [title, ...more] = says[lane.says[event]].split("\n");
    const facts = [
      ["at", `${instantText(this.origin, at, perSecond)}`],
      ["from 0", `${lengthText(at, perSecond)}, ${cyclesText(at, this.perCycle(lane))}${at < 0 ? " before" : ""}`],
    ];
    const until = lane.kind === "boxes" ? lane.end[event] : lane.kind === "wave" ? lane.at[event + 1] : undefined;
    if (until !== undefined) facts.push([lane.kind === "boxes" ? "lasts" : "until next", this.long(until - at, lane)]);
    const before = event > 0 ? at - lane.at[event - 1] : undefined;
    if (before !== undefined && lane.kind !== "boxes") facts.push(["since last", this.long(before, lane)]);
    const where = this.firmwareAt(at, lane);
    if (where) facts.push(["firmware", where]);
    this.say(title, more, facts, x, y);
  },

  explainLevel(lane, tick, x, y) {
    const after = upTo(lane.at, tick);
    const level = lane.initial ^ (after & 1) ? "high" : "low";
    const since = lane.at[after - 1];
    const until = lane.at[after];
    const facts = [["at", instantText(this.origin, tick, this.data.perSecond)]];
    if (since !== undefined && until !== undefined) facts.push(["for", this.long(until - since, lane)]);
    const where = this.firmwareAt(tick, lane);
    if (where) facts.push(["firmware", where]);
    this.say(`${lane.name} ${level}`, [], facts, x, y);
  },

  long(ticks, lane) { return `${lengthText(ticks, this.data.perSecond)} (${cyclesText(ticks, this.perCycle(lane))})`; },

  /** What the firmware was at: in a service routine, a wait or a span; else where it made its last access. */
  firmwareAt(tick, lane) {
    const unit = lane.unit || (this.units.length === 1 ? this.units[0] : "");
    const lanes = this.groups.flatMap((group) => group.lanes).filter((other) => other.unit === unit && other !== lane);
    for (const name of ["interrupt", "wait", "span"]) {
      for (const other of lanes.filter((one) => one.name === name && one.kind === "boxes")) {
        const place = upTo(other.at, tick) - 1;
        if (place >= 0 && other.end[place] >= tick) return this.data.says[other.says[place]].replace("\n", " ");
      }
    }
    if (lane.places) return ""; // an access says itself where it is
    let found = null;
    for (const other of lanes.filter((one) => one.places)) {
      const last = upTo(other.at, tick) - 1;
      if (last >= 0 && (found === null || other.at[last] > found.at)) {
        found = { at: other.at[last], place: this.data.says[other.places[last]] };
      }
    }
    return found && `last access at ${found.place}, ${lengthText(tick - found.at, this.data.perSecond)} before`;
  },

  say(title, lines, facts, x, y) {
    const put = (name, text) => Object.assign(document.createElement(name), { textContent: text });
    const list = document.createElement("dl");
    for (const [name, text] of facts) list.append(put("dt", name), put("dd", text));
    this.tip.replaceChildren(put("strong", title), ...lines.map((line) => put("p", line)), list);
    this.tip.hidden = false;
    const stage = this.svg.parentElement.getBoundingClientRect();
    const left = x + 14 + this.tip.offsetWidth > stage.width ? x - 14 - this.tip.offsetWidth : x + 14;
    this.tip.style.left = `${Math.max(0, Math.min(left, stage.width - this.tip.offsetWidth))}px`;
    const above = y - 12 - this.tip.offsetHeight;
    this.tip.style.top = `${y + 18 + this.tip.offsetHeight > stage.height && above > 0 ? above : y + 18}px`;
  },

  hide() { this.tip.hidden = true; },
};
