// The picture: what is in it, and where it is seen from.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { Box } from "./box.js";
import { Chains } from "./chains.js";
import { MANY, Spheres } from "./spheres.js";

/** How much of the picture a flat box takes. */
const FILLED = 0.92;
/** The angle that the picture takes of the eye's view, in degrees. */
const ANGLE = 30;
/** The eye's distance over that from which the ball around the box is seen whole; its corners take less room. */
const NEARER = 0.95;
/** The room that spheres at corners take, over the distance from which the corners themselves are seen. */
const ROOM = 1.05;
/** The share of their radii with which spheres are drawn between the forces of contacts. */
const SMALL = 0.3;

function renderer(antialias) {
  const canvas = document.createElement("canvas");
  // Nothing of the page is to be seen through edges that cover a pixel in part.
  const context = canvas.getContext("webgl2", { antialias, alpha: false });
  return new THREE.WebGLRenderer({ canvas, context });
}

export class View {
  constructor(run, place) {
    this.run = run;
    this.place = place;
    this.isDue = false;
    this.renderer = renderer(run.count < MANY);
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setClearColor(0xffffff);
    place.append(this.renderer.domElement);
    [this.spheres, this.box, this.scene] = [new Spheres(run), new Box(run), new THREE.Scene()];
    this.scene.add(this.spheres.mesh, this.box.lines);
    if (run.chains) this.scene.add((this.chains = new Chains(run)).mesh);
    this.measure();
    this.camera = run.flat ? new THREE.OrthographicCamera() : new THREE.PerspectiveCamera(ANGLE);
    this.orbit = new OrbitControls(this.camera, this.renderer.domElement);
    this.reset();
    this.orbit.addEventListener("change", () => this.draw());
    new ResizeObserver(() => this.resize()).observe(place);
  }

  /** The middle of the box as it stands straight, the radius of a ball around it, and how wide the box is as it tilts. */
  measure() {
    const [a, b, c] = [0, 3, 6].map((first) => new THREE.Vector3(...this.run.edges[0].slice(first, first + 3)));
    // Of a box that tilts, the one that stands straight.
    b.x = 0;
    if (this.run.flat) c.set(0, 0, 0);
    this.size = a.clone().add(b).add(c);
    this.middle = this.size.clone().multiplyScalar(0.5);
    this.radius = this.size.length() / 2;
    const tilts = this.run.edges.map((edges) => Math.abs(edges[3]));
    this.width = this.size.x + 2 * tilts.reduce((most, tilt) => Math.max(most, tilt), 0);
  }

  /** Puts the eye where it is at first. */
  reset() {
    const { up, flat } = this.run;
    this.camera.up.set(0, Number(up === "y"), Number(up === "z"));
    const away = flat ? [0, 0, 1] : up === "y" ? [0.35, 0.3, 1] : [0.5, -1, 0.4];
    const direction = new THREE.Vector3(...away).normalize();
    const distance = flat ? 2 * this.radius : this.distance(direction);
    this.camera.position.copy(this.middle).addScaledVector(direction, distance);
    this.camera.zoom = 1;
    this.orbit.target.copy(this.middle);
    this.resize();
    this.orbit.update();
  }

  /** How far away the eye is in a direction to see the box whole, in a picture that may be narrow. */
  distance(direction) {
    const { clientWidth, clientHeight } = this.place;
    const aspect = clientWidth / clientHeight || 1;
    const narrow = Math.min(1, (aspect * this.size.x) / this.width);
    const half = Math.tan((ANGLE * Math.PI) / 360);
    const ofBall = (NEARER * this.radius) / Math.sin(Math.atan(half * narrow));
    return Math.max(ofBall, ROOM * this.distanceOfCorners(direction, half, aspect));
  }

  /** The distance from which all corners are seen: those of a long box are at the edge of the ball around it. */
  distanceOfCorners(direction, half, aspect) {
    const across = new THREE.Vector3().crossVectors(this.camera.up, direction).normalize();
    const upwards = new THREE.Vector3().crossVectors(direction, across);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((number) => {
      const sides = [0, 1, 2].map((axis) => ((number >> axis) & 1) - 0.5);
      return new THREE.Vector3(...sides).multiply(this.size);
    });
    const needed = corners.map((corner) => {
      const seen = Math.max(Math.abs(corner.dot(upwards)), Math.abs(corner.dot(across)) / aspect);
      return corner.dot(direction) + seen / half;
    });
    return Math.max(...needed);
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.place;
    if (!width || !height) return;
    this.renderer.setSize(width, height);
    const aspect = width / height;
    Object.assign(this.camera, { near: 0.01 * this.radius, far: 100 * this.radius });
    if (this.run.flat) {
      const half = Math.max(this.size.y, this.width / aspect) / 2 / FILLED;
      Object.assign(this.camera, { left: -half * aspect, right: half * aspect, top: half, bottom: -half });
    } else {
      this.camera.aspect = aspect;
    }
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /** Shows a frame. */
  show(frame, colouring) {
    this.spheres.show(frame, colouring);
    this.box.show(frame);
    this.chains?.show(frame);
    this.draw();
  }

  /** Shows the forces of contacts between small spheres, or spheres as they are. */
  showChains(isShown) {
    this.chains.mesh.visible = isShown;
    this.spheres.shrink(isShown ? SMALL : 1);
    this.draw();
  }

  /** Shows the axes of spheres, or not. */
  showAxes(isShown) {
    this.spheres.cap(isShown);
    this.draw();
  }

  /** Draws soon: once, however much changes until then. */
  draw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      this.drawNow();
    });
  }

  drawNow() {
    const distance = this.camera.position.distanceTo(this.middle);
    if (this.run.flat) this.spheres.setHaze(1e30, 2e30);
    else this.spheres.setHaze(distance - this.radius, distance + 1.4 * this.radius);
    this.renderer.render(this.scene, this.camera);
  }
}
