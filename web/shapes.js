// The links of the arm as capsules, and a coloured disc on each joint.

import {
  CapsuleGeometry,
  CylinderGeometry,
  Group,
  Matrix4,
  Mesh,
  MeshStandardMaterial,
  Quaternion,
  Vector3,
} from "three";

const UP = new Vector3(0, 1, 0);

/// Position of a joint's disc along the joint axis, its radius and its height [m], for each joint of each arm.
const PLANAR = [0.21, 0.195, 0.18, 0.165].map((radius) => [0, radius, 0.34]);
const PANDA = [
  [-0.19, 0.08, 0.022],
  [0, 0.052, 0.268],
  [-0.12, 0.074, 0.022],
  [0, 0.048, 0.232],
  [-0.2, 0.072, 0.022],
  [-0.025, 0.047, 0.222],
  [0.077, 0.055, 0.02],
];

export class ArmShapes extends Group {
  constructor(simulator, look, ghost = false) {
    super();
    const body = material(ghost ? look.soft : look.body, ghost);
    const dof = simulator.dof;
    this.links = Array.from({ length: dof + 1 }, () => new Group());
    this.add(...this.links);
    for (const link of this.links) link.matrixAutoUpdate = false;
    for (let i = 0; i < 8; ++i) {
      const [link, ax, ay, az, bx, by, bz, radius] = simulator.capsules.subarray(8 * i, 8 * i + 8);
      if (radius > 0) this.links[link].add(capsule(new Vector3(ax, ay, az), new Vector3(bx, by, bz), radius, body));
    }
    const discs = simulator.arm === 0 ? PLANAR : PANDA;
    for (let i = 0; i < dof; ++i) {
      const [along, radius, height] = discs[i];
      this.links[i + 1].add(disc(along, radius, height, ghost ? body : material(look.joints[i], ghost)));
    }
    this.traverse((part) => {
      part.castShadow = part.receiveShadow = part.isMesh === true && !ghost;
    });
    this.show(simulator.frames);
  }

  /// frames: the frames of a view.
  show(frames) {
    this.links.forEach((link, i) => {
      const [px, py, pz, xx, xy, xz, yx, yy, yz, zx, zy, zz] = frames.subarray(12 * i, 12 * i + 12);
      link.matrix.set(xx, yx, zx, px, xy, yy, zy, py, xz, yz, zz, pz, 0, 0, 0, 1);
      link.matrixWorldNeedsUpdate = true;
    });
  }

  dispose() {
    this.traverse((part) => {
      part.geometry?.dispose();
      part.material?.dispose();
    });
  }
}

function material(color, ghost) {
  // The ghost is drawn behind the arm if both coincide.
  const faint = { transparent: true, opacity: 0.24, depthWrite: false, polygonOffset: true, polygonOffsetFactor: 4 };
  return new MeshStandardMaterial({ color, roughness: 0.45, metalness: 0.05, ...(ghost ? faint : {}) });
}

function capsule(a, b, radius, how) {
  const axis = b.clone().sub(a);
  const mesh = new Mesh(new CapsuleGeometry(radius, axis.length(), 12, 32), how);
  mesh.position.copy(a).addScaledVector(axis, 0.5);
  if (axis.length() > 0) mesh.quaternion.setFromUnitVectors(UP, axis.normalize());
  return mesh;
}

function disc(along, radius, height, how) {
  const mesh = new Mesh(new CylinderGeometry(radius, radius, height, 48), how);
  mesh.position.z = along;
  mesh.quaternion.copy(new Quaternion().setFromRotationMatrix(new Matrix4().makeRotationX(Math.PI / 2)));
  return mesh;
}
