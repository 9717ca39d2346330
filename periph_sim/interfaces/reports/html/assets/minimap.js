// The strip above the waves: all that was kept, how much happened where, and which part is in view.

const BUCKETS = 200;

class Minimap {
  constructor(timeline) {
    this.timeline = timeline;
    this.svg = timeline.figure.querySelector(".minimap");
    this.svg.addEventListener("pointerdown", (event) => {
      this.svg.setPointerCapture(event.pointerId);
      this.go(event);
    });
    this.svg.addEventListener("pointermove", (event) => event.buttons && this.go(event));
  }

  x(tick) {
    const { first, last } = this.timeline;
    return (1000 * (tick - first)) / Math.max(last - first, 1);
  }

  /** Draw what does not depend on the view. */
  load() {
    const { data, groups, first, last } = this.timeline;
    const counts = new Array(BUCKETS).fill(0);
    for (const lane of groups.flatMap((group) => group.lanes)) {
      for (const at of lane.at) counts[Math.min(Math.floor((BUCKETS * (at - first)) / Math.max(last - first, 1)), BUCKETS - 1)] += 1;
    }
    const most = Math.log1p(Math.max(...counts, 1));
    const bars = counts.map((count, n) => {
      const height = ((18 * Math.log1p(count)) / most).toFixed(1);
      return count ? `M${n * 5} 24v-${height}h5v${height}z` : "";
    });
    const begin = this.x(data.begin);
    const width = Math.max(this.x(data.end) - begin, 2);
    this.window = svg("rect", { class: "view", y: 0, height: 24 });
    this.svg.replaceChildren(
      svg("path", { class: "activity", d: bars.join("") }),
      ...data.kept.slice(1).map(([from], i) => this.box("hole", this.x(data.kept[i][1]), this.x(from))),
      svg("rect", { class: "occurrence", x: begin.toFixed(1), y: 0, width: width.toFixed(1), height: 24 }),
      this.window,
    );
  }

  box(name, from, to) { return svg("rect", { class: name, x: from, y: 0, width: to - from, height: 24 }); }

  view() {
    const width = Math.max(this.x(this.timeline.to) - this.x(this.timeline.from), 6);
    this.window.setAttribute("x", ((this.x(this.timeline.from) + this.x(this.timeline.to) - width) / 2).toFixed(1));
    this.window.setAttribute("width", width.toFixed(1));
  }

  /** Bring the place under the pointer into the middle of the view. */
  go(event) {
    const box = this.svg.getBoundingClientRect();
    const { first, last, from, to } = this.timeline;
    const middle = first + ((event.clientX - box.left) / box.width) * (last - first);
    this.timeline.show(middle - (to - from) / 2, middle + (to - from) / 2);
  }
}
