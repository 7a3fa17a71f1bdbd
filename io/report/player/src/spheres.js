// All particles of a frame, drawn at once.

import * as THREE from "three";
import { palette } from "./colours.js";
import { fragment, vertex } from "./shaders.js";

/** From as many particles on their edges are not smoothed, which would take too long. */
export const MANY = 30000;
/** Particles or lines in a row of a texture; a power of two. */
export const ROW = 1024;

/** A texture with some numbers for each particle or line, whose values are fetched as they are. */
export function listed(array, count, format, type) {
  const texture = new THREE.DataTexture(array, ROW, Math.ceil(count / ROW), format, type);
  texture.unpackAlignment = 1;
  texture.needsUpdate = true;
  return texture;
}

/** A texture of 256 colours. */
function colours(isOfKinds) {
  const texture = new THREE.DataTexture(palette(isOfKinds), 256, 1);
  texture.needsUpdate = true;
  return texture;
}

/** Six corners of two triangles for each particle or line, of which a shader knows only the number. */
export function geometry(count) {
  const made = new THREE.BufferGeometry();
  made.setDrawRange(0, 6 * count);
  return made;
}

export class Spheres {
  constructor(run) {
    this.run = run;
    const room = ROW * Math.ceil(run.count / ROW);
    const radii = new Float32Array(room);
    radii.set(run.radii);
    this.places = listed(new Uint16Array(4 * room), run.count, THREE.RGBAIntegerFormat, THREE.UnsignedShortType);
    this.places.internalFormat = "RGBA16UI";
    this.axes = listed(new Int8Array(4 * room), run.count, THREE.RGBAIntegerFormat, THREE.ByteType);
    this.axes.internalFormat = "RGBA8I";
    this.palettes = { kinds: colours(true), scale: colours(false) };
    this.uniforms = {
      edges: { value: new THREE.Matrix3() },
      places: { value: this.places },
      axes: { value: this.axes },
      capped: { value: 0 },
      radii: { value: listed(radii, run.count, THREE.RedFormat, THREE.FloatType) },
      share: { value: 1 },
      palette: { value: this.palettes.kinds },
      haze: { value: new THREE.Vector2() },
    };
    const material = new THREE.ShaderMaterial({
      vertexShader: vertex,
      fragmentShader: fragment,
      uniforms: this.uniforms,
      alphaToCoverage: run.count < MANY,
    });
    this.mesh = new THREE.Mesh(geometry(run.count), material);
    this.mesh.frustumCulled = false;
  }

  /** Puts the particles where they are in a frame, in the colours of a colouring. */
  show(frame, colouring) {
    const { count, positions, edges } = this.run;
    const [first, ofColour] = [3 * count * frame, colouring.fixed ? 0 : count * frame];
    const data = this.places.image.data;
    for (let i = 0; i < count; i++) {
      for (let axis = 0; axis < 3; axis++) data[4 * i + axis] = positions[first + 3 * i + axis];
      data[4 * i + 3] = colouring.values[ofColour + i];
    }
    this.places.needsUpdate = true;
    if (this.run.axes) this.turn(first);
    this.uniforms.palette.value = colouring.names ? this.palettes.kinds : this.palettes.scale;
    // The lattice vectors are the columns.
    this.uniforms.edges.value.fromArray(edges[frame]);
  }

  /** Turns the axes to those in the list from a place on. */
  turn(first) {
    const { count, axes } = this.run;
    const data = this.axes.image.data;
    for (let i = 0; i < count; i++) {
      for (let axis = 0; axis < 3; axis++) data[4 * i + axis] = axes[first + 3 * i + axis];
    }
    this.axes.needsUpdate = true;
  }

  /** Draws them with caps at their axes, or without. */
  cap(isCapped) {
    this.uniforms.capped.value = Number(isCapped);
  }

  /** Draws them with a share of their radii. */
  shrink(share) {
    this.uniforms.share.value = share;
  }

  /** Distances from the eye between which particles grow pale. */
  setHaze(near, far) {
    this.uniforms.haze.value.set(near, far);
  }
}
