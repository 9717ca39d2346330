// The table of verdicts: a click on a title sorts, a click again turns it round; buttons and a word filter.

for (const place of document.querySelectorAll(".verdicts")) {
  const body = place.querySelector("tbody");
  const titles = [...place.querySelectorAll("th")];
  const rows = [...body.rows];
  let shown = "all";

  const key = (row, column) => {
    const cell = row.cells[column];
    if (!("sort" in cell.dataset)) return cell.textContent.trim().toLowerCase();
    return cell.dataset.sort === "" ? -Infinity : Number(cell.dataset.sort);
  };

  const sort = (column) => {
    const up = titles[column].getAttribute("aria-sort") !== "ascending";
    titles.forEach((title) => title.removeAttribute("aria-sort"));
    titles[column].setAttribute("aria-sort", up ? "ascending" : "descending");
    const ordered = [...body.rows].sort((one, other) => {
      const [a, b] = [key(one, column), key(other, column)];
      return (a < b ? -1 : a > b ? 1 : 0) * (up ? 1 : -1);
    });
    body.replaceChildren(...ordered);
  };

  const filter = () => {
    const word = place.querySelector("input").value.trim().toLowerCase();
    for (const row of rows) {
      row.hidden = (shown !== "all" && row.dataset.verdict !== shown) || !row.textContent.toLowerCase().includes(word);
    }
    place.querySelector(".none").hidden = rows.some((row) => !row.hidden);
  };

  titles.forEach((title, column) => title.querySelector("button").addEventListener("click", () => sort(column)));
  place.querySelector("input").addEventListener("input", filter);
  for (const button of place.querySelectorAll("[data-show]")) {
    button.addEventListener("click", () => {
      shown = button.dataset.show;
      for (const one of place.querySelectorAll("[data-show]")) one.setAttribute("aria-pressed", one === button);
      filter();
    });
  }
}
