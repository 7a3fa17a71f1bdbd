// What the colours say.

import { kindColour, scaleGradient } from "./colours.js";

function element(name, className, content = "") {
  const made = document.createElement(name);
  made.className = className;
  made.textContent = content;
  return made;
}

function kind(name, number) {
  const [entry, patch] = [element("span", "kind"), element("span", "patch")];
  patch.style.background = kindColour(number);
  entry.append(patch, name);
  return entry;
}

/** Fills a place with the legend of a colouring. */
export function showLegend(place, colouring) {
  if (colouring.names) {
    place.replaceChildren(...colouring.names.map(kind));
    return;
  }
  const bar = element("span", "scale");
  bar.style.background = scaleGradient();
  const [low, high] = colouring.range;
  place.replaceChildren(element("span", "end", low), bar, element("span", "end", high), element("span", "", colouring.label));
}
