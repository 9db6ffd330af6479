/**
 * Binary frames of the stream, little endian; docs/serve.md describes them. A decoded frame refers to the buffer that
 * came, it copies nothing.
 */

const POSES = 1;
const LINES = 2;
const COLORS = 3;
const POINTS = 4;

/** A colour of a frame that stands for the node's own. */
export const OWN_COLOR = 0xffffffff;

/** Words of 4 bytes per record. */
export const POSE_STRIDE = 8;
export const LINE_STRIDE = 7;
export const COLOR_STRIDE = 2;
export const POINT_STRIDE = 3;

function records(buffer, header, stride, count, kind) {
  const expected = header + count * stride * 4;
  if (buffer.byteLength !== expected) {
    throw new RangeError(`a frame of ${kind} has ${buffer.byteLength} bytes, ${count} records need ${expected}`);
  }
  return {
    count,
    ints: new Uint32Array(buffer, header, count * stride),
    floats: new Float32Array(buffer, header, count * stride),
  };
}

/**
 * Decodes a frame. Every kind has `count` records in `ints` and `floats`, two views of the same words:
 * - `poses`: node, x, y, z, qx, qy, qz, qw; with `sequence`, `step` and `time` in s
 * - `lines`: x, y, z, x, y, z, colour; with `step`
 * - `colors`: node, colour or OWN_COLOR; with `step`
 * - `points`: x, y, z of all cloths; with `step`
 * Throws RangeError for anything else.
 * @param {ArrayBuffer} buffer
 */
export function decodeFrame(buffer) {
  if (buffer.byteLength < 16) throw new RangeError(`a frame has ${buffer.byteLength} bytes, the header alone needs 16`);
  const header = new DataView(buffer);
  const word = (index) => header.getUint32(index * 4, true);
  switch (word(0)) {
    case POSES:
      if (buffer.byteLength < 32) throw new RangeError('a frame of poses is shorter than its header');
      return {
        kind: 'poses',
        sequence: word(1),
        step: word(2),
        time: header.getFloat64(16, true),
        ...records(buffer, 32, POSE_STRIDE, word(3), 'poses'),
      };
    case LINES:
      return { kind: 'lines', step: word(1), ...records(buffer, 16, LINE_STRIDE, word(2), 'lines') };
    case COLORS:
      return { kind: 'colors', step: word(1), ...records(buffer, 16, COLOR_STRIDE, word(2), 'colours') };
    case POINTS:
      return { kind: 'points', step: word(1), ...records(buffer, 16, POINT_STRIDE, word(2), 'points') };
    default:
      throw new RangeError(`a frame of unknown kind ${word(0)}`);
  }
}
