"use strict";
// The slider and the swap key of comparisons; everything else is plain HTML.
document.documentElement.classList.add("scripted");
for (const comparison of document.querySelectorAll(".comparison")) {
  const stage = comparison.querySelector(".stage");
  const range = comparison.querySelector(".cut input");
  const view = (name) => comparison.querySelector(`[value=${name}]`);
  const cut = () => stage.style.setProperty("--cut", `${range.value}%`);
  const drag = (event) => {
    if (!view("slider").checked || !(event.buttons & 1)) return;
    const box = stage.getBoundingClientRect();
    range.value = (100 * (event.clientX - box.left)) / box.width;
    cut();
  };
  range.addEventListener("input", cut);
  stage.addEventListener("pointerdown", (event) => {
    if (!view("slider").checked) return;
    event.preventDefault();
    stage.setPointerCapture(event.pointerId);
    drag(event);
  });
  stage.addEventListener("pointermove", drag);
}
// The comparison that has the focus or lies below the pointer; one alone always.
const all = [...document.querySelectorAll(".comparison")];
const current = () =>
  document.activeElement.closest(".comparison") ||
  document.querySelector(".comparison:hover") ||
  (all.length === 1 ? all[0] : null);
// S shows the one picture in place of the other.
const swap = (comparison) => {
  if (!comparison) return;
  const left = comparison.querySelector("[value=left]");
  const next = left.checked ? comparison.querySelector("[value=right]") : left;
  next.checked = true;
};
// N and P go to the next and the previous comparison.
const go = (step) => {
  const from = all.indexOf(current());
  const to = from < 0 ? (step > 0 ? 0 : all.length - 1) : from + step;
  if (!all[to]) return;
  all[to].querySelector(":checked").focus({ preventScroll: true });
  (all[to].closest("section") || all[to]).scrollIntoView();
};
const keys = { s: () => swap(current()), n: () => go(1), p: () => go(-1) };
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const act = keys[event.key.toLowerCase()];
  if (act) act();
});
