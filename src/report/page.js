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
// S shows the one picture in place of the other, in the comparison that has
// the focus or lies below the pointer.
document.addEventListener("keydown", (event) => {
  if (event.key.toLowerCase() !== "s" || event.ctrlKey || event.metaKey || event.altKey) return;
  const comparison =
    document.activeElement.closest(".comparison") || document.querySelector(".comparison:hover");
  if (!comparison) return;
  const left = comparison.querySelector("[value=left]");
  const next = left.checked ? comparison.querySelector("[value=right]") : left;
  next.checked = true;
});
