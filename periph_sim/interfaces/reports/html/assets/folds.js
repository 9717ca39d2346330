// What is folded is made when it is opened; links open what they lead to; n and p step through violations.

/** The Timeline of a figure, made when it is first needed. */
function timelineOf(figure) {
  figure.timeline ??= new Timeline(figure);
  return figure.timeline;
}

const isOpen = (element) => !element.parentElement.closest("details:not([open])");

function unfold() {
  for (const figure of document.querySelectorAll(".timeline")) if (isOpen(figure)) timelineOf(figure);
  for (const figure of document.querySelectorAll(".overtime")) if (isOpen(figure)) figure.overTime ??= new OverTime(figure);
}

/** Open the target of the address, and all that it lies in. */
function follow() {
  const target = location.hash.length > 1 && document.getElementById(decodeURIComponent(location.hash.slice(1)));
  if (!target) return;
  for (let at = target; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  target.querySelector("details")?.setAttribute("open", "");
  unfold();
  target.scrollIntoView();
}

/** The plot that a key is meant for: that of the budget with the focus, else the first one in sight. */
function plotInSight() {
  const within = document.activeElement?.closest(".budget")?.querySelector(".overtime");
  const plots = [...document.querySelectorAll(".overtime")].filter((figure) => figure.overTime?.data.at.length && isOpen(figure));
  if (within && plots.includes(within)) return within.overTime;
  const seen = plots.find((figure) => figure.closest(".budget").getBoundingClientRect().bottom > 0);
  return (seen ?? plots[0])?.overTime;
}

document.addEventListener("toggle", unfold, true);
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || event.target.matches("input")) return;
  const by = { n: 1, p: -1 }[event.key];
  if (by) plotInSight()?.step(by);
});
window.addEventListener("hashchange", follow);
unfold();
follow();
