// What the report's page does: copies tables, lays one picture over another, magnifies both.
"use strict";
(() => {
  for (const button of document.querySelectorAll("button[data-copy]")) {
    const text = button.closest("figure").querySelector("pre");
    button.hidden = false;
    button.addEventListener("click", () => {
      const range = document.createRange();
      range.selectNodeContents(text);
      getSelection().removeAllRanges();
      getSelection().addRange(range);
      button.textContent = document.execCommand("copy") ? "Copied" : "Selected";
    });
  }
})();

(() => {
  const get = (id) => document.getElementById(id);
  const viewport = get("viewport"), stage = get("stage"), wipe = get("wipe");
  const left = get("left"), right = get("right"), view = get("view"), zoom = get("zoom");
  const pictures = [...stage.querySelectorAll("img")];
  if (!pictures.length || !left.options.length) return;
  const name = (select) => select.options[select.selectedIndex].text;

  /* The line stays where it is in the window while the picture scrolls beneath it. */
  const place = () => {
    const share = Number(wipe.value) / 100;
    stage.style.setProperty("--at", `${viewport.scrollLeft + share * viewport.clientWidth}px`);
    get("tag-left").style.opacity = share > 0.04 ? 1 : 0;
    get("tag-right").style.opacity = share < 0.96 ? 1 : 0;
  };

  const show = () => {
    for (const picture of pictures) {
      const here = picture.dataset.view === view.value;
      picture.classList.toggle("left", here && picture.dataset.strategy === left.value);
      picture.classList.toggle("right", here && picture.dataset.strategy === right.value);
    }
    get("tag-left").textContent = name(left);
    get("tag-right").textContent = name(right);
    describe();
  };

  const describe = () => {
    const share = Number(wipe.value);
    wipe.setAttribute("aria-valuetext", `${share} % ${name(left)}, ${100 - share} % ${name(right)}`);
    place();
  };

  /* (x, y) of the picture, 0 to 1, comes to the middle of the window. */
  const magnify = (x, y) => {
    const factor = Number(zoom.value);
    stage.style.width = factor ? `${factor * viewport.dataset.width}px` : "100%";
    stage.style.aspectRatio = viewport.style.aspectRatio;
    stage.classList.toggle("zoomed", factor > 0);
    viewport.scrollLeft = x * stage.clientWidth - viewport.clientWidth / 2;
    viewport.scrollTop = y * stage.clientHeight - viewport.clientHeight / 2;
    place();
  };

  const middle = () => [
    (viewport.scrollLeft + viewport.clientWidth / 2) / stage.clientWidth,
    (viewport.scrollTop + viewport.clientHeight / 2) / stage.clientHeight,
  ];

  let drag = null;
  stage.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const zoomed = stage.classList.contains("zoomed");
    const onLine = event.target === get("handle");
    if (zoomed && !onLine && event.pointerType !== "mouse") return;
    drag = { wipes: onLine || !zoomed, x: event.clientX, y: event.clientY, left: viewport.scrollLeft, top: viewport.scrollTop };
    stage.setPointerCapture(event.pointerId);
    move(event);
  });
  const move = (event) => {
    if (!drag) return;
    if (drag.wipes) {
      const box = viewport.getBoundingClientRect();
      wipe.value = String((100 * (event.clientX - box.left)) / viewport.clientWidth);
      describe();
    } else {
      viewport.scrollLeft = drag.left + drag.x - event.clientX;
      viewport.scrollTop = drag.top + drag.y - event.clientY;
    }
  };
  stage.addEventListener("pointermove", move);
  for (const end of ["pointerup", "pointercancel"]) stage.addEventListener(end, () => { drag = null; });

  wipe.addEventListener("input", describe);
  viewport.addEventListener("scroll", place, { passive: true });
  window.addEventListener("resize", place);
  for (const select of [left, right, view]) select.addEventListener("change", show);
  let before = [0.5, 0.5];
  zoom.addEventListener("change", () => magnify(...before));
  viewport.addEventListener("scroll", () => { before = middle(); }, { passive: true });
  get("swap").addEventListener("click", () => {
    [left.value, right.value] = [right.value, left.value];
    show();
  });
  for (const button of document.querySelectorAll("button[data-x]")) {
    button.hidden = false;
    button.addEventListener("click", () => {
      view.value = button.dataset.view;
      zoom.value = "4";
      show();
      magnify(Number(button.dataset.x), Number(button.dataset.y));
      get("viewer").scrollIntoView();
      viewport.focus({ preventScroll: true });
    });
  }

  stage.classList.add("live");
  magnify(0.5, 0.5);
  show();

  /* With #selftest at the end of its address the page works its own controls, and leaves what came
   * of it in an attribute of its root: what the tests read. */
  if (location.hash === "#selftest") window.addEventListener("load", () => {
    const at = () => stage.style.getPropertyValue("--at");
    const set = (control, value, event) => {
      control.value = value;
      control.dispatchEvent(new Event(event));
    };
    const shown = () => pictures.filter((picture) => getComputedStyle(picture).display !== "none");
    const outcome = {};
    set(wipe, "20", "input");
    const low = at();
    set(wipe, "80", "input");
    outcome.slider = low !== at() && parseFloat(at()) > parseFloat(low);
    outcome.clipped = getComputedStyle(stage.querySelector("img.left")).clipPath !== "none";
    set(left, left.options[0].value, "change");
    set(right, right.options[right.options.length - 1].value, "change");
    const names = [name(left), name(right)];
    get("swap").click();
    outcome.swapped = name(left) === names[1] && name(right) === names[0];
    outcome.pictures = shown().length;
    outcome.decoded = shown().every((picture) => picture.complete && picture.naturalWidth > 0);
    set(zoom, "4", "change");
    outcome.zoomed = stage.clientWidth === 4 * Number(viewport.dataset.width);
    outcome.dark = matchMedia("(prefers-color-scheme: dark)").matches;
    outcome.paper = getComputedStyle(document.body).backgroundColor;
    outcome.ink = getComputedStyle(document.body).color;
    const scrolls = document.documentElement.scrollWidth - document.documentElement.clientWidth;
    outcome.sideways = scrolls > 0;
    document.documentElement.dataset.selftest = JSON.stringify(outcome);
  });
})();
