/**
 * Poses are seven numbers: position x, y, z and rotation x, y, z, w. Matrices are 16 numbers, column by column, as
 * WebGL wants them.
 */

/** Writes the 3×3 rotation of the quaternion at `q[i…]`, scaled per axis, into the columns of `out[o…]`. */
function writeRotation(out, o, q, i, scale) {
  const x = q[i],
    y = q[i + 1],
    z = q[i + 2],
    w = q[i + 3];
  const [sx, sy, sz] = scale;
  out[o] = (1 - 2 * (y * y + z * z)) * sx;
  out[o + 1] = 2 * (x * y + w * z) * sx;
  out[o + 2] = 2 * (x * z - w * y) * sx;
  out[o + 3] = 0;
  out[o + 4] = 2 * (x * y - w * z) * sy;
  out[o + 5] = (1 - 2 * (x * x + z * z)) * sy;
  out[o + 6] = 2 * (y * z + w * x) * sy;
  out[o + 7] = 0;
  out[o + 8] = 2 * (x * z + w * y) * sz;
  out[o + 9] = 2 * (y * z - w * x) * sz;
  out[o + 10] = (1 - 2 * (x * x + y * y)) * sz;
  out[o + 11] = 0;
}

const ONE = [1, 1, 1];

/** The matrix of a pose with a scale. */
export function poseMatrix(pose, scale = ONE) {
  const out = new Float32Array(16);
  writeRotation(out, 0, pose, 3, scale);
  out.set([pose[0], pose[1], pose[2], 1], 12);
  return out;
}

const rotation = new Float32Array(12);

/** Writes the first three rows of pose · part at `out[o…]`, for a part of the body whose pose is at `poses[p…]`. */
export function writePartRows(out, o, poses, p, part) {
  writeRotation(rotation, 0, poses, p + 3, ONE);
  const r = rotation;
  for (let column = 0; column < 4; ++column) {
    const x = part[column * 4],
      y = part[column * 4 + 1],
      z = part[column * 4 + 2];
    out[o + column] = r[0] * x + r[4] * y + r[8] * z;
    out[o + 4 + column] = r[1] * x + r[5] * y + r[9] * z;
    out[o + 8 + column] = r[2] * x + r[6] * y + r[10] * z;
  }
  out[o + 3] += poses[p];
  out[o + 7] += poses[p + 1];
  out[o + 11] += poses[p + 2];
}

/** Writes the first three rows of a matrix at `out[o…]`. */
export function writeRows(out, o, matrix) {
  for (let row = 0; row < 3; ++row) {
    for (let column = 0; column < 4; ++column) out[o + row * 4 + column] = matrix[column * 4 + row];
  }
}

/** Writes the pose between two at `out[o…]`: straight on the shorter way, which is exact enough for one frame. */
export function blendPose(out, a, b, o, t) {
  const near = a[o + 3] * b[o + 3] + a[o + 4] * b[o + 4] + a[o + 5] * b[o + 5] + a[o + 6] * b[o + 6] < 0 ? -1 : 1;
  for (let i = 0; i < 3; ++i) out[o + i] = a[o + i] + t * (b[o + i] - a[o + i]);
  let squared = 0;
  for (let i = 3; i < 7; ++i) {
    const value = a[o + i] * near * (1 - t) + b[o + i] * t;
    out[o + i] = value;
    squared += value * value;
  }
  const scale = 1 / Math.sqrt(squared);
  for (let i = 3; i < 7; ++i) out[o + i] *= scale;
}

/** The world's point in the frame of a pose. */
export function toLocal(pose, point) {
  const [px, py, pz, qx, qy, qz, qw] = pose;
  return rotate([-qx, -qy, -qz, qw], [point[0] - px, point[1] - py, point[2] - pz]);
}

/** A point of the frame of a pose, in the world. */
export function toWorld(pose, point) {
  const turned = rotate([pose[3], pose[4], pose[5], pose[6]], point);
  return [turned[0] + pose[0], turned[1] + pose[1], turned[2] + pose[2]];
}

/** v turned by the unit quaternion q: v + 2 q × (q × v + w v). */
export function rotate([x, y, z, w], [vx, vy, vz]) {
  const tx = 2 * (y * vz - z * vy),
    ty = 2 * (z * vx - x * vz),
    tz = 2 * (x * vy - y * vx);
  return [vx + w * tx + y * tz - z * ty, vy + w * ty + z * tx - x * tz, vz + w * tz + x * ty - y * tx];
}
