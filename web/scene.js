// The scene: light, ground, links, target, path of the tip, and a ghost of the posture in which the tip stopped.

import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  CircleGeometry,
  DirectionalLight,
  Group,
  HemisphereLight,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  PCFShadowMap,
  PerspectiveCamera,
  PlaneGeometry,
  Points,
  PointsMaterial,
  RingGeometry,
  Scene,
  ShadowMaterial,
  SphereGeometry,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

import { ArmShapes } from "./shapes.js";

const TRACE = 600; // Number of points of the tip's path.

/// Camera, centre of the view, visible width and height [m], and size of the target [m].
const STAGES = {
  planar: { from: [0.8, 0.1, 10], at: [1.6, 1.05, 0], width: 4.7, height: 3.5, size: 0.16 },
  panda: { from: [2.7, 1.05, 1.25], at: [0.22, 0.42, 0], width: 1.4, height: 1.0, size: 0.036 },
};

export class Stage {
  /// covered(): heights that text covers at the top and at the bottom of the canvas [pixels].
  constructor(canvas, look, covered) {
    this.covered = covered;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFShadowMap;
    this.camera = new PerspectiveCamera(32, 1, 0.05, 60);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.enablePan = false;
    this.orbit.enableDamping = true;
    this.scene = new Scene();
    this.world = new Group(); // With the axes of the base frame.
    this.scene.add(this.world);
    this.light();
    this.look = look;
  }

  light() {
    this.sun = new DirectionalLight(0xffffff, 2.1);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(2048, 2048);
    this.sun.shadow.radius = 6;
    this.sky = new HemisphereLight(0xffffff, 0x8f98a8, 1.5);
    this.scene.add(this.sun, this.sun.target, this.sky, new AmbientLight(0xffffff, 0.35));
  }

  /// Shows another arm. look: colours by name.
  set(simulator, look = this.look) {
    this.look = look;
    this.flat = simulator.arm === 0;
    const stage = this.flat ? STAGES.planar : STAGES.panda;
    this.stage = stage;
    // The view of a planar arm is from above only, and a drag beside the target scrolls the page.
    this.orbit.enabled = !this.flat;
    this.renderer.domElement.style.touchAction = this.flat ? "pan-y" : "none";
    this.arm?.dispose();
    this.ghost?.dispose();
    this.world.clear();
    this.world.rotation.x = this.flat ? 0 : -Math.PI / 2;
    this.arm = new ArmShapes(simulator, look);
    this.ghost = new ArmShapes(simulator, look, true);
    this.ghost.visible = false;
    this.target = target(stage.size, look.target);
    this.trace = trace(look.target);
    this.passed = 0;
    this.world.add(this.arm, this.ghost, this.target, this.trace, ...this.ground(look));
    this.sun.position.fromArray(this.flat ? [-2, 5, 8] : [1.2, 3, 1.6]);
    this.sun.target.position.fromArray(stage.at);
    const shadow = this.sun.shadow.camera;
    shadow.left = shadow.bottom = -stage.width;
    shadow.right = shadow.top = stage.width;
    shadow.near = 0.1;
    shadow.far = 20;
    shadow.updateProjectionMatrix();
    this.resize(true);
  }

  ground(look) {
    const board = new Mesh(new PlaneGeometry(60, 60), new ShadowMaterial({ opacity: look.shadow }));
    board.receiveShadow = true;
    board.position.z = this.flat ? -0.5 : -0.002;
    if (!this.flat) {
      const plate = new Mesh(new CircleGeometry(0.6, 96), new MeshStandardMaterial({ color: look.ground }));
      plate.position.z = -0.004;
      plate.receiveShadow = true;
      return [board, plate];
    }
    const base = new Mesh(new RingGeometry(0.24, 0.29, 64), new MeshBasicMaterial({ color: look.faint }));
    base.position.z = -0.16;
    return [board, base];
  }

  /// Fits the drawing to the canvas. home: also fits the view to the arm.
  resize(home = false) {
    const { clientWidth: width, clientHeight: height } = this.renderer.domElement;
    if (width === 0 || height === 0) return;
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    const [top, bottom] = this.covered();
    this.camera.setViewOffset(width, height, 0, (bottom - top) / 2, width, height);
    if (!home) return;
    const half = Math.tan((this.camera.fov * Math.PI) / 360);
    const high = (this.stage.height * height) / Math.max(height - top - bottom, 120);
    const distance = Math.max(high, this.stage.width / this.camera.aspect) / (2 * half);
    const at = new Vector3(...this.stage.at);
    const direction = new Vector3(...this.stage.from).sub(at).normalize();
    this.camera.position.copy(at).addScaledVector(direction, distance);
    this.orbit.target.copy(at);
    this.orbit.minDistance = 0.3 * distance;
    this.orbit.maxDistance = 2.5 * distance;
    this.orbit.update();
  }

  /// goal: position of the dragged target, in the base frame.
  show(simulator, goal) {
    this.arm.show(simulator.frames);
    this.target.position.fromArray(goal);
    this.target.getObjectByName("halo").quaternion.copy(this.camera.quaternion);
    if (!this.flat) this.target.getObjectByName("halo").quaternion.premultiply(this.world.quaternion.clone().invert());
  }

  /// Shows a ghost of the current posture, or hides the ghost.
  rest(simulator) {
    this.ghost.visible = Boolean(simulator);
    if (simulator) this.ghost.show(simulator.frames);
  }

  /// Extends the path of the tip.
  pass(tip) {
    const points = this.trace.geometry.attributes.position;
    if (this.passed === TRACE) points.array.copyWithin(0, 3);
    else this.passed += 1;
    points.array.set(tip, 3 * (this.passed - 1));
    points.needsUpdate = true;
    this.trace.geometry.setDrawRange(0, this.passed);
  }

  forget() {
    this.passed = 0;
    this.trace.geometry.setDrawRange(0, 0);
  }

  draw() {
    this.orbit.update();
    this.renderer.render(this.scene, this.camera);
  }
}

function target(size, color) {
  const group = new Group();
  const seen = { color, transparent: true, depthTest: false }; // Visible through the arm.
  const ball = new Mesh(new SphereGeometry(size, 32, 24), new MeshStandardMaterial({ ...seen, roughness: 0.3 }));
  const halo = new Mesh(
    new RingGeometry(1.7 * size, 1.95 * size, 64),
    new MeshBasicMaterial({ ...seen, opacity: 0.9 }),
  );
  halo.name = "halo";
  ball.renderOrder = halo.renderOrder = 2;
  group.add(ball, halo);
  return group;
}

function trace(color) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * TRACE), 3));
  geometry.setDrawRange(0, 0);
  const dots = { color, size: 3, sizeAttenuation: false };
  const points = new Points(geometry, new PointsMaterial({ ...dots, transparent: true, opacity: 0.7 }));
  points.frustumCulled = false;
  return points;
}
