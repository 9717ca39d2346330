// The values over the whole run: steps from one value beyond a limit to the next, and moves the waves with it.

class OverTime {
  constructor(figure) {
    this.figure = figure;
    this.field = figure.querySelector(".field");
    this.now = figure.querySelector(".now");
    this.told = figure.querySelector(".told");
    this.data = JSON.parse(figure.querySelector("script").textContent);
    this.place = -1; // in data.at; -1: at the worst
    for (const at of this.data.waves) this.field.append(this.mark(at));
    for (const button of figure.querySelectorAll("[data-step]")) {
      button.addEventListener("click", () => this.step(Number(button.dataset.step)));
    }
    this.field.addEventListener("click", (event) => this.click(event));
    if (this.data.worst !== null) this.put(this.data.worst);
  }

  get timeline() { return timelineOf(this.figure.closest(".budget").querySelector(".timeline")); }

  percent(at) { return `${((100 * at) / this.data.end).toFixed(3)}%`; }

  mark(at) {
    const mark = Object.assign(document.createElement("span"), { className: "kept", title: "its waves are kept" });
    mark.style.left = this.percent(at);
    return mark;
  }

  put(at) {
    this.now.style.left = this.percent(at);
    this.now.hidden = false;
  }

  /** To the next violation (by 1) or the one before (by -1), round and round. */
  step(by) {
    const { at, worst } = this.data;
    if (!at.length) return;
    if (this.place < 0) {
      const after = upTo(at, worst ?? -1); // the first step leaves the worst
      this.place = by > 0 ? after % at.length : (after - 2 + 2 * at.length) % at.length;
    } else {
      this.place = (this.place + by + at.length) % at.length;
    }
    this.show(this.place);
  }

  show(place) {
    const { at, texts, count, waves } = this.data;
    this.place = place;
    this.put(at[place]);
    const about = `violation ${place + 1} of ${count}: ${texts[place]} at ${at[place].toFixed(6)} s`;
    const number = waves.indexOf(at[place]);
    if (number >= 0) this.timeline.load(number, `${number ? "Occurrence" : "Worst occurrence"}, ${about}`);
    this.told.textContent = number >= 0 ? about : `${about}; its waves are not kept, those below are of another`;
  }

  /** To the violation nearest to the pointer. */
  click(event) {
    const { at, end } = this.data;
    if (!at.length) return;
    const box = this.field.getBoundingClientRect();
    const there = ((event.clientX - box.left) / box.width) * end;
    const after = upTo(at, there);
    const place = after > 0 && (after === at.length || there - at[after - 1] < at[after] - there) ? after - 1 : after;
    this.show(place);
  }
}
