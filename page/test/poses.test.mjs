import assert from 'node:assert/strict';
import { test } from 'node:test';
import { PoseStore } from '../src/poses.js';
import { POSE_STRIDE } from '../src/protocol.js';

const at = (x) => [x, 0, 0, 0, 0, 0, 1];

function frame(...entries) {
    const floats = new Float32Array(entries.length * POSE_STRIDE);
    const ints = new Uint32Array(floats.buffer);
    entries.forEach(([node, x], i) => {
        ints[i * POSE_STRIDE] = node;
        floats.set(at(x), i * POSE_STRIDE + 1);
    });
    return { count: entries.length, ints, floats };
}

function draw(store, time) {
    const changed = [];
    store.draw(time, (slot) => changed.push(slot));
    return changed;
}

function storeOf(...nodes) {
    const store = new PoseStore();
    nodes.forEach((node) => store.add(node, at(0)));
    draw(store, 1);
    return store;
}

test('what is drawn at the end of the way is exactly what was received', () => {
    const store = storeOf(10, 20);
    store.receive(frame([10, 0.1], [20, 7]));
    assert.equal(draw(store, 1).length, 2);
    assert.deepEqual([...store.pose(10)], [...new Float32Array(at(0.1))]);
    assert.deepEqual(draw(store, 1), [], 'nothing is left to draw');
});

test('between two frames bodies are between their poses', () => {
    const store = storeOf(10);
    store.receive(frame([10, 4]));
    draw(store, 0.25);
    assert.equal(store.pose(10)[0], 1);
    draw(store, 0.5);
    assert.equal(store.pose(10)[0], 2);
});

test('a body that the next frame leaves out comes to rest at its last pose', () => {
    const store = storeOf(10, 20);
    store.receive(frame([10, 4], [20, 2]));
    draw(store, 0.5);
    store.receive(frame([20, 4]));
    draw(store, 0.5);
    assert.equal(store.pose(10)[0], 4);
    assert.equal(store.pose(20)[0], 3);
});

test('a frame that was never drawn is where the next one starts from', () => {
    const store = storeOf(10);
    store.receive(frame([10, 4]));
    store.receive(frame([10, 6]));
    draw(store, 0.5);
    assert.equal(store.pose(10)[0], 5);
});

test('slots of removed nodes are used again, many nodes make it grow, unknown nodes are passed over', () => {
    const store = storeOf(1, 2);
    const slot = store.slot(1);
    store.remove(1);
    store.remove(99);
    assert.equal(store.pose(1), undefined);
    assert.equal(store.add(3, at(3)), slot);
    for (let node = 100; node < 400; ++node) store.add(node, at(node));
    store.receive(frame([1, 5], [399, 5]));
    draw(store, 1);
    assert.equal(store.pose(3)[0], 3);
    assert.equal(store.pose(398)[0], 398);
    assert.equal(store.pose(399)[0], 5);
    assert.equal([...store.nodes()].length, 302);
});
