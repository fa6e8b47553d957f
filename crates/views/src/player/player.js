"use strict";
// A page says last, word (what a step is called), wait (in milliseconds) and draw(step), adds to
// keys, and begins.
const $ = (id) => document.getElementById(id);
const data = JSON.parse($("data").textContent);
let at = 0, timer = 0;

function show(step, keep) {
  at = Math.max(0, Math.min(last, step));
  draw(at);
  const words = word + " " + at + " of " + last;
  $("step").textContent = words;
  $("bar").value = at;
  $("bar").setAttribute("aria-valuetext", words);
  $("back").disabled = $("first").disabled = at === 0;
  $("next").disabled = $("last").disabled = at === last;
  // Browsers refuse to have the address changed all the time.
  if (!keep && !timer) address();
  if (at === last) stop();
}

function address() {
  history.replaceState(null, "", "#" + at);
}

function stop() {
  if (timer) address();
  clearInterval(timer);
  timer = 0;
  $("play").textContent = "Play";
}

function play() {
  if (timer) return stop();
  if (at === last) show(0);
  timer = setInterval(() => show(at + 1), wait);
  $("play").textContent = "Stop";
}

function dark(yes) {
  document.documentElement.classList.toggle("dark", yes);
}
const wish = matchMedia("(prefers-color-scheme: dark)");
dark(wish.matches);
wish.addEventListener("change", () => dark(wish.matches));

const keys = {
  ArrowRight: () => show(at + 1), ArrowLeft: () => show(at - 1),
  " ": () => show(at + 1), PageDown: () => show(at + 1), PageUp: () => show(at - 1),
  Home: () => show(0), End: () => show(last),
  p: play, d: () => dark(!document.documentElement.classList.contains("dark")),
  f: () => document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen(),
  "?": () => $("keys").showModal(),
};
addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.altKey || event.metaKey || $("keys").open) return;
  // A button that has the focus is pressed by the space bar.
  if (event.key === " " && event.target instanceof HTMLButtonElement) return;
  const action = keys[event.key.length === 1 ? event.key.toLowerCase() : event.key];
  if (!action) return;
  event.preventDefault();
  action();
});
$("first").onclick = keys.Home;
$("back").onclick = keys.ArrowLeft;
$("next").onclick = keys.ArrowRight;
$("last").onclick = keys.End;
$("play").onclick = play;
$("dark").onclick = keys.d;
$("help").onclick = keys["?"];
$("bar").oninput = () => show(Number($("bar").value));

let touch = null;
addEventListener("touchstart", (event) => {
  const finger = event.changedTouches[0];
  touch = event.touches.length === 1 && !event.target.closest("nav, dialog") ? finger : null;
}, { passive: true });
addEventListener("touchend", (event) => {
  if (!touch) return;
  const x = event.changedTouches[0].clientX - touch.clientX, y = event.changedTouches[0].clientY - touch.clientY;
  if (Math.abs(x) > 40 && Math.abs(x) > 2 * Math.abs(y)) show(at + (x < 0 ? 1 : -1));
}, { passive: true });

function begin() {
  const wanted = () => show(parseInt(location.hash.slice(1), 10) || 0, true);
  addEventListener("hashchange", wanted);
  wanted();
}
