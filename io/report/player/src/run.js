// What the page knows of the run: a description as JSON, and lists of numbers as base64, each in an element of its own.

const text = (id) => document.getElementById(id).textContent.trim();

/** The bytes of a list. */
function bytes(id) {
  const binary = atob(text(id));
  const result = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; i++) result[i] = binary.charCodeAt(i);
  return result;
}

/**
 * The run that the page is about. `positions` has three numbers for each particle of each frame in turn, coordinates
 * along the edges of the box in 65536ths. Each colouring has a number from 0 to 255 for each particle, of each frame
 * in turn unless it is `fixed`. With `chains` there are lines, so many of each frame in turn: three coordinates of the
 * start as of positions, three from there to the end in 32768ths, and a width from 0 to 255. If it is `oriented`, `axes`
 * has three components from -127 to 127 for each particle of each frame in turn.
 */
export function readRun() {
  const run = JSON.parse(text("run"));
  run.radii = new Float32Array(bytes("radii").buffer);
  run.positions = new Uint16Array(bytes("positions").buffer);
  if (run.oriented) run.axes = new Int8Array(bytes("axes").buffer);
  if (run.chains) {
    const lines = bytes("chains").buffer;
    Object.assign(run.chains, { starts: new Uint16Array(lines), steps: new Int16Array(lines), widths: bytes("widths") });
  }
  run.colourings.forEach((colouring, number) => (colouring.values = bytes(`colouring-${number}`)));
  return run;
}
