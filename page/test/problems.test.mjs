import assert from 'node:assert/strict';
import { test } from 'node:test';
import { reportProblems } from '../src/problems.js';

/** What is shown of messages that a session tells. */
function shown(...messages) {
    const listeners = new Map();
    const told = [];
    reportProblems(
        { on: (type, listener) => listeners.set(type, listener) },
        { show: (kind, text) => told.push([kind, text]), dismiss: (key) => told.push(['gone', key]) },
    );
    for (const [type, message] of messages) listeners.get(type)(message);
    return told;
}

test('warnings of a scene are shown, of many the first three and how many more there are', () => {
    assert.deepEqual(shown(['scene', {}]), []);
    assert.deepEqual(shown(['scene', { warnings: ['a', 'b'] }]), [
        ['info', 'a'],
        ['info', 'b'],
    ]);
    assert.deepEqual(shown(['scene', { warnings: ['a', 'b', 'c', 'd', 'e'] }]), [
        ['info', 'a'],
        ['info', 'b'],
        ['info', 'c'],
        ['info', 'and 2 more warnings'],
    ]);
});

test('a file that cannot be read again says that its values stay', () => {
    assert.deepEqual(shown(['file', { path: 'a.json', ok: false, message: 'a.json:3: no number' }]), [
        ['error', 'a.json:3: no number – the values before stay'],
    ]);
});
