// The table beside the waves: what was said on the bus and on serial lines; a click on a time moves the waves there.

const ROOM = 0.15; // of a row's length, on both sides of it in the waves

class Protocol {
  constructor(timeline) {
    this.timeline = timeline;
    this.place = timeline.figure.querySelector(".protocol");
    this.body = this.place.querySelector("tbody");
    this.word = this.place.querySelector("input");
    this.word.addEventListener("input", () => this.filter());
  }

  load() {
    this.rows = this.timeline.data.rows.map((row) => this.row(row));
    this.body.replaceChildren(...this.rows.map(({ element }) => element));
    this.moved = false;
    this.filter();
  }

  /** [at, end, bus, start, address, way, ack, [[byte, ack, expected] ...], stop] as a row of the table. */
  row([at, end, bus, start, address, way, ack, data, stop]) {
    const put = (name, text, className = "") => Object.assign(document.createElement(name), { textContent: text, className });
    const answer = (text, wrong) => put("small", text, wrong ? "wrong" : "");
    const go = Object.assign(put("button", lengthText(at, this.timeline.data.perSecond)), { type: "button" });
    const cells = [put("td", "", "number"), put("td", bus), put("td", ""), put("td", "")];
    cells[0].append(go);
    if (start) cells[2].append(put("small", start), ` ${[address, way].filter(Boolean).join(" ")} `, answer(ack, ack === "NACK"));
    for (const [byte, said, expected] of data) {
      const one = put("span", byte, expected ? "wrong" : "");
      if (expected) one.append(" ", answer(`not ${expected}`, true));
      if (said) one.append(" ", answer(said, said === "error" || (said === "NACK" && way === "W"))); // a read ends with NACK
      cells[3].append(one, " ");
    }
    if (stop) cells[3].append(put("small", "STOP"));
    const element = document.createElement("tr");
    element.append(...cells);
    element.addEventListener("click", () => this.go(at, end));
    return { element, at, end };
  }

  go(at, end) {
    const { perSecond } = this.timeline.data;
    const room = Math.max(ROOM * (end - at), 5e-6 * perSecond);
    this.timeline.show(at - room, end + room);
  }

  filter() {
    const words = this.word.value.trim().toLowerCase().split(/\s+/);
    let count = 0;
    for (const { element } of this.rows) {
      const text = element.textContent.toLowerCase();
      element.hidden = !words.every((word) => text.includes(word));
      count += !element.hidden;
    }
    const all = this.rows.length;
    this.place.querySelector(".count").textContent = count === all ? `${all} rows` : `${count} of ${all} rows`;
  }

  /** Mark the rows that are in view, and scroll to the first of them. */
  view() {
    const { from, to } = this.timeline;
    const inside = this.rows.filter(({ element, at, end }) => {
      const shown = at <= to && end >= from;
      element.classList.toggle("inview", shown);
      return shown && !element.hidden;
    });
    const scroll = this.place.querySelector(".scroll");
    if (!inside.length || scroll.matches(":hover")) return; // who reads there is not disturbed
    const top = inside[0].element.offsetTop - scroll.querySelector("thead").offsetHeight;
    if (top < scroll.scrollTop || top > scroll.scrollTop + scroll.clientHeight * 0.7) scroll.scrollTop = top;
  }
}
