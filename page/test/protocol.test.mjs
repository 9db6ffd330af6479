import assert from 'node:assert/strict';
import { test } from 'node:test';
import { COLOR_STRIDE, decodeFrame, LINE_STRIDE, OWN_COLOR, POINT_STRIDE, POSE_STRIDE } from '../src/protocol.js';

function posesFrame({ sequence, step, time, poses }) {
    const buffer = new ArrayBuffer(32 + poses.length * POSE_STRIDE * 4);
    const view = new DataView(buffer);
    [1, sequence, step, poses.length].forEach((value, i) => view.setUint32(i * 4, value, true));
    view.setFloat64(16, time, true);
    poses.forEach(([node, ...pose], i) => {
        view.setUint32(32 + i * 32, node, true);
        pose.forEach((value, k) => view.setFloat32(36 + i * 32 + k * 4, value, true));
    });
    return buffer;
}

test('a frame of poses has step, time, and node and seven numbers per record', () => {
    const frame = decodeFrame(
        posesFrame({
            sequence: 9,
            step: 600,
            time: 10,
            poses: [
                [7, 1, 2, 3, 0, 0, 0, 1],
                [4000000000, -1.5, 0.25, 8, 0.5, 0.5, 0.5, 0.5],
            ],
        }),
    );
    assert.deepEqual([frame.kind, frame.sequence, frame.step, frame.time, frame.count], ['poses', 9, 600, 10, 2]);
    assert.equal(frame.ints[0], 7);
    assert.deepEqual([...frame.floats.subarray(1, 8)], [1, 2, 3, 0, 0, 0, 1]);
    assert.equal(frame.ints[POSE_STRIDE], 4000000000);
    assert.equal(frame.floats[POSE_STRIDE + 1], -1.5);
});

test('an empty frame of poses still tells the step', () => {
    const frame = decodeFrame(posesFrame({ sequence: 1, step: 5, time: 0.5, poses: [] }));
    assert.deepEqual([frame.step, frame.count], [5, 0]);
});

test('a frame of lines has two points and a colour per record', () => {
    const buffer = new ArrayBuffer(16 + LINE_STRIDE * 4);
    new Uint32Array(buffer).set([2, 33, 1, 0]);
    new Float32Array(buffer).set([0, 1, 2, 3, 4, 5], 4);
    new Uint32Array(buffer)[10] = 0xff8000;
    const frame = decodeFrame(buffer);
    assert.deepEqual([frame.kind, frame.step, frame.count], ['lines', 33, 1]);
    assert.deepEqual([...frame.floats.subarray(0, 6)], [0, 1, 2, 3, 4, 5]);
    assert.equal(frame.ints[6], 0xff8000);
});

test('a frame of colours has a node and its colour per record', () => {
    const frame = decodeFrame(new Uint32Array([3, 1, 2, 0, 5, 0x123456, 6, OWN_COLOR]).buffer);
    assert.deepEqual([frame.kind, frame.count, ...frame.ints], ['colors', 2, 5, 0x123456, 6, OWN_COLOR]);
    assert.equal(COLOR_STRIDE, 2);
});

test('a frame of points has the places of all cloths', () => {
    const buffer = new ArrayBuffer(16 + 2 * POINT_STRIDE * 4);
    new Uint32Array(buffer).set([4, 33, 2, 0]);
    new Float32Array(buffer).set([0, 1, 2, 3, 4, 5], 4);
    const frame = decodeFrame(buffer);
    assert.deepEqual([frame.kind, frame.step, frame.count, ...frame.floats], ['points', 33, 2, 0, 1, 2, 3, 4, 5]);
});

test('what is no frame is refused', () => {
    assert.throws(() => decodeFrame(new ArrayBuffer(4)), /4 bytes/);
    assert.throws(() => decodeFrame(new Uint32Array([9, 0, 0, 0]).buffer), /unknown kind 9/);
    assert.throws(() => decodeFrame(new Uint32Array([1, 0, 0, 0]).buffer), /shorter than its header/);
    assert.throws(() => decodeFrame(new Uint32Array([3, 0, 2, 0, 5, 0]).buffer), /24 bytes, 2 records need 32/);
    const long = posesFrame({ sequence: 1, step: 1, time: 0, poses: [[1, 0, 0, 0, 0, 0, 0, 1]] });
    assert.throws(() => decodeFrame(long.slice(0, 60)), RangeError);
});
