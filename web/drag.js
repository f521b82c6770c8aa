// Drags the target by mouse, finger or arrow keys. A drag beside the target rotates the view.

import { Plane, Raycaster, Vector2, Vector3 } from "three";

const NEAR = { mouse: 36, touch: 56, pen: 44 }; // Largest distance of a pointer from target or tip for a drag [pixels].
const EDGE = 16; // Distance of the target from the edge of the canvas [pixels].

export class Drag {
  /// goal(), tip(): positions of target and tip. moved(point), began(), ended(): called during a drag.
  constructor(stage, { goal, tip, moved, began, ended }) {
    this.stage = stage;
    this.asked = { goal, tip, moved, began, ended };
    this.pointer = null;
    this.ray = new Raycaster();
    const canvas = stage.renderer.domElement;
    // Captured before OrbitControls receives the event.
    canvas.addEventListener("pointerdown", (event) => this.down(event), { capture: true });
    canvas.addEventListener("pointermove", (event) => this.move(event), { capture: true });
    for (const end of ["pointerup", "pointercancel"]) {
      canvas.addEventListener(end, (event) => this.up(event), { capture: true });
    }
    canvas.addEventListener("keydown", (event) => this.key(event));
    // A finger on the target does not scroll the page.
    const held = (event) => this.active && event.preventDefault();
    canvas.addEventListener("touchstart", held, { passive: false });
    canvas.addEventListener("touchmove", held, { passive: false });
  }

  get active() {
    return this.pointer !== null;
  }

  down(event) {
    if (this.active || event.button !== 0) return;
    const reach = NEAR[event.pointerType] ?? NEAR.mouse;
    const near = [this.asked.goal(), this.asked.tip()].find((point) => this.distance(event, point) < reach);
    if (!near) return;
    event.stopImmediatePropagation();
    event.preventDefault();
    this.stage.renderer.domElement.setPointerCapture(event.pointerId);
    this.pointer = event.pointerId;
    const at = this.inWorld(near);
    const normal = this.stage.flat ? new Vector3(0, 0, 1) : this.stage.camera.getWorldDirection(new Vector3());
    this.plane = new Plane().setFromNormalAndCoplanarPoint(normal, at);
    const hit = this.hit(event);
    this.grip = hit ? this.inWorld(this.asked.goal()).sub(hit) : new Vector3();
    if (near === this.asked.tip()) this.grip.set(0, 0, 0);
    this.asked.began();
  }

  move(event) {
    const canvas = this.stage.renderer.domElement;
    if (event.pointerId !== this.pointer) {
      if (!this.active) canvas.classList.toggle("over", this.distance(event, this.asked.goal()) < NEAR.mouse);
      return;
    }
    event.stopImmediatePropagation();
    const hit = this.hit(event);
    if (hit) this.asked.moved(this.stage.world.worldToLocal(hit.add(this.grip)).toArray());
  }

  up(event) {
    if (event.pointerId !== this.pointer) return;
    event.stopImmediatePropagation();
    this.pointer = null;
    this.asked.ended();
  }

  key(event) {
    const direction = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!direction) return;
    event.preventDefault();
    const step = 0.4 * this.stage.stage.size;
    const right = new Vector3().setFromMatrixColumn(this.stage.camera.matrixWorld, 0);
    const up = new Vector3().setFromMatrixColumn(this.stage.camera.matrixWorld, 1);
    const at = this.inWorld(this.asked.goal());
    at.addScaledVector(right, step * direction[0]).addScaledVector(up, step * direction[1]);
    this.asked.began();
    this.asked.moved(this.stage.world.worldToLocal(at).toArray());
    this.asked.ended();
  }

  inWorld(point) {
    return this.stage.world.localToWorld(new Vector3(...point));
  }

  /// Position on the page of a point of the base frame.
  onPage(point) {
    const seen = this.inWorld(point).project(this.stage.camera);
    const box = this.stage.renderer.domElement.getBoundingClientRect();
    return [box.left + ((seen.x + 1) / 2) * box.width, box.top + ((1 - seen.y) / 2) * box.height];
  }

  /// Distance on the page of a pointer from a point of the base frame.
  distance(event, point) {
    const [x, y] = this.onPage(point);
    return Math.hypot(event.clientX - x, event.clientY - y);
  }

  /// The point under a pointer, limited to the canvas, so that the target stays visible.
  hit(event) {
    const box = this.stage.renderer.domElement.getBoundingClientRect();
    const within = (value, size) => Math.min(Math.max(value, EDGE), size - EDGE);
    const x = (2 * within(event.clientX - box.left, box.width)) / box.width - 1;
    const y = 1 - (2 * within(event.clientY - box.top, box.height)) / box.height;
    this.ray.setFromCamera(new Vector2(x, y), this.stage.camera);
    return this.ray.ray.intersectPlane(this.plane, new Vector3());
  }
}
