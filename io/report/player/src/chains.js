// Forces of contacts: lines from centre to centre, as thick as the force is large.

import * as THREE from "three";
import { fragment, vertex } from "./chain_shaders.js";
import { ROW, geometry, listed } from "./spheres.js";

/** The radius of the thickest line, over that of the largest sphere. */
const THICKEST = 0.3;

export class Chains {
  constructor(run) {
    this.run = run;
    const { counts } = run.chains;
    this.firsts = counts.map(((sum) => (count) => (sum += count) - count)(0));
    const most = Math.max(...counts);
    const rows = ROW * Math.ceil(most / ROW);
    const texture = (array, type, format) => Object.assign(listed(array, most, THREE.RGBAIntegerFormat, type), { internalFormat: format });
    this.starts = texture(new Uint16Array(4 * rows), THREE.UnsignedShortType, "RGBA16UI");
    this.steps = texture(new Int16Array(4 * rows), THREE.ShortType, "RGBA16I");
    this.uniforms = {
      edges: { value: new THREE.Matrix3() },
      starts: { value: this.starts },
      steps: { value: this.steps },
      thickest: { value: THICKEST * run.radii.reduce((most, radius) => Math.max(most, radius), 0) },
    };
    const material = new THREE.ShaderMaterial({ vertexShader: vertex, fragmentShader: fragment, uniforms: this.uniforms });
    this.mesh = new THREE.Mesh(geometry(most), material);
    this.mesh.frustumCulled = false;
    this.mesh.visible = false;
  }

  show(frame) {
    const { chains, edges } = this.run;
    const [count, first] = [chains.counts[frame], this.firsts[frame]];
    for (let i = 0; i < count; i++) {
      const from = 6 * (first + i);
      for (let axis = 0; axis < 3; axis++) {
        this.starts.image.data[4 * i + axis] = chains.starts[from + axis];
        this.steps.image.data[4 * i + axis] = chains.steps[from + 3 + axis];
      }
      this.starts.image.data[4 * i + 3] = chains.widths[first + i];
    }
    this.mesh.geometry.setDrawRange(0, 6 * count);
    this.starts.needsUpdate = true;
    this.steps.needsUpdate = true;
    this.uniforms.edges.value.fromArray(edges[frame]);
  }
}
