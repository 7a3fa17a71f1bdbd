// The player of the page of a run.

import { Player } from "./player.js";
import { readRun } from "./run.js";
import { View } from "./view.js";

const picture = document.getElementById("picture");

function start() {
  const run = readRun();
  new Player(run, new View(run, picture));
}

function canDraw() {
  return document.createElement("canvas").getContext("webgl2") !== null;
}

if (canDraw()) start();
else picture.textContent = "This browser does not draw in three dimensions: it has no WebGL 2.";
