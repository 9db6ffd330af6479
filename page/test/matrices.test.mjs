import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Matrix4, Quaternion, Vector3 } from 'three';
import { blendPose, poseMatrix, rotate, toLocal, toWorld, writePartRows, writeRows } from '../src/matrices.js';

const near = (a, b, tolerance = 1e-6) =>
    [...a].forEach((value, i) => assert.ok(Math.abs(value - b[i]) <= tolerance, `[${[...a]}] is not [${[...b]}]`));
const turn = (axis, angle) => new Quaternion().setFromAxisAngle(new Vector3(...axis).normalize(), angle).toArray();
const pose = [1, -2, 3, ...turn([1, 2, -1], 0.7)];
const part = [0.1, 0.2, -0.3, ...turn([0, 1, 1], -1.1)];
const compose = (p, scale) =>
    new Matrix4().compose(new Vector3(...p.slice(0, 3)), new Quaternion(...p.slice(3)), new Vector3(...scale));

test('the matrix of a pose is the one of three.js', () => {
    near(poseMatrix(pose, [1, 2, 3]), compose(pose, [1, 2, 3]).elements);
});

test('a part is placed by its body', () => {
    const expected = compose(pose, [1, 1, 1])
        .multiply(compose(part, [2, 3, 4]))
        .transpose().elements;
    const rows = new Float32Array(16);
    writePartRows(rows, 2, new Float32Array([0, ...pose]), 1, poseMatrix(part, [2, 3, 4]));
    near(rows.subarray(2, 14), expected.slice(0, 12));
    writeRows(rows, 4, compose(pose, [1, 1, 1]).elements);
    near(rows.subarray(4, 16), compose(pose, [1, 1, 1]).transpose().elements.slice(0, 12));
});

test('a point of the world goes into a body and back', () => {
    near(toWorld(pose, toLocal(pose, [4, 5, 6])), [4, 5, 6]);
    near(rotate(turn([0, 1, 0], Math.PI / 2), [0, 0, 1]), [1, 0, 0]);
});

test('half way between two rotations is half the angle, on the shorter way', () => {
    const from = new Float32Array([0, 0, 0, ...turn([0, 1, 0], 0.2)]);
    const to = new Float32Array([2, 4, 6, ...turn([0, 1, 0], 0.4).map((value) => -value)]);
    const between = new Float32Array(7);
    blendPose(between, from, to, 0, 0.5);
    near(between.subarray(0, 3), [1, 2, 3]);
    // q and −q are the same rotation.
    const cosine = new Quaternion(...between.subarray(3)).dot(new Quaternion(...turn([0, 1, 0], 0.3)));
    assert.ok(Math.abs(cosine) > 1 - 1e-6);
});
