// Which frame is shown in which colours, and the user's hand on it.

import { showLegend } from "./legend.js";

/** Seconds that all frames take, and the most and least of them a second. */
const [SECONDS, FASTEST, SLOWEST] = [12, 30, 4];

const find = (id) => document.getElementById(id);

export class Player {
  constructor(run, view) {
    [this.run, this.view, this.isPlaying] = [run, view, false];
    [this.slider, this.button, this.choice] = [find("frame"), find("play"), find("colouring")];
    this.slider.max = run.times.length - 1;
    this.choice.replaceChildren(...run.colourings.map(({ name }, number) => new Option(name, number)));
    this.slider.addEventListener("input", () => this.show(this.slider.valueAsNumber));
    this.button.addEventListener("click", () => this.toggle());
    this.choice.addEventListener("change", () => this.colour());
    find("reset").addEventListener("click", () => view.reset());
    find("show-axes")?.addEventListener("change", (event) => view.showAxes(event.target.checked));
    find("show-chains")?.addEventListener("change", (event) => view.showChains(event.target.checked));
    document.addEventListener("keydown", (event) => this.key(event));
    this.frame = 0;
    this.colour();
  }

  get colouring() {
    return this.run.colourings[this.choice.value];
  }

  colour() {
    showLegend(find("legend"), this.colouring);
    this.show(this.frame);
  }

  /** Shows a frame; after the last one comes the first. */
  show(frame) {
    const count = this.run.times.length;
    this.frame = (frame + count) % count;
    this.slider.value = this.frame;
    const time = Number(this.run.times[this.frame].toPrecision(6));
    find("time").textContent = `time ${time}, step ${this.run.steps[this.frame]}`;
    this.view.show(this.frame, this.colouring);
  }

  toggle() {
    this.isPlaying = !this.isPlaying;
    this.button.textContent = this.isPlaying ? "Pause" : "Play";
    this.last = performance.now();
    if (this.isPlaying) requestAnimationFrame((now) => this.play(now));
  }

  /** Shows the next frame when it is time, as often as the browser can draw. */
  play(now) {
    if (!this.isPlaying) return;
    const rate = Math.min(FASTEST, Math.max(SLOWEST, this.run.times.length / SECONDS));
    if (now - this.last >= 1000 / rate) {
      this.last = now;
      this.show(this.frame + 1);
    }
    requestAnimationFrame((next) => this.play(next));
  }

  key(event) {
    const last = this.run.times.length - 1;
    const moves = { ArrowRight: this.frame + 1, ArrowLeft: this.frame - 1, Home: 0, End: last };
    const isBox = event.target.type === "checkbox";
    const isElsewhere = isBox || event.target instanceof HTMLSelectElement || event.ctrlKey || event.altKey || event.metaKey;
    if (isElsewhere || !(event.key === " " || event.key in moves)) return;
    event.preventDefault();
    if (event.key === " ") this.toggle();
    else this.show(moves[event.key]);
  }
}
