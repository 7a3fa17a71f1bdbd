// The outline of the box, which tilts as it is sheared.

import * as THREE from "three";

const FLAT = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]];
const LOOP = [[0, 1], [1, 2], [2, 3], [3, 0]];

/** Ends of the edges, in box coordinates. */
function ends(isFlat) {
  const lower = LOOP.flat().map((corner) => FLAT[corner]);
  if (isFlat) return lower;
  const upper = lower.map(([x, y]) => [x, y, 1]);
  const pillars = FLAT.flatMap((corner) => [corner, [corner[0], corner[1], 1]]);
  return [...lower, ...upper, ...pillars];
}

export class Box {
  constructor(run) {
    this.run = run;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(ends(run.flat).flat(), 3));
    this.lines = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ color: 0x444444 }));
    this.lines.matrixAutoUpdate = false;
    this.lines.frustumCulled = false;
  }

  show(frame) {
    const [a, b, c, d, e, f, g, h, i] = this.run.edges[frame];
    this.lines.matrix.set(a, d, g, 0, b, e, h, 0, c, f, i, 0, 0, 0, 0, 1);
    this.lines.matrixWorldNeedsUpdate = true;
  }
}
