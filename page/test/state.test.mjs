import assert from 'node:assert/strict';
import { test } from 'node:test';
import { FrameClock } from '../src/frame_clock.js';
import { History } from '../src/history.js';
import { limitMargin, solverPlots, vehiclePlots } from '../src/plot_list.js';
import { LEVELS, Quality } from '../src/quality.js';
import { findTunables, groupTree } from '../src/tunable_groups.js';

test('a history keeps the last seconds and forgets what is taken back', () => {
    const history = new History(2, [(message) => message.value]);
    for (let time = 0; time <= 5; ++time) history.add({ time, value: 10 * time });
    assert.deepEqual(history.columns, [
        [3, 4, 5],
        [30, 40, 50],
    ]);
    history.add({ time: 4, value: 7 });
    assert.deepEqual(history.columns, [
        [3, 4],
        [30, 7],
    ]);
    history.add({ time: 0 });
    assert.deepEqual(history.columns, [[0], [null]]);
});

test('plots read what the telemetry has, and nothing where it has nothing', () => {
    const wheel = { slipRatio: 0.1, slipAngle: Math.PI / 180, load: 3000, longitudinal: 500, lateral: -500 };
    const message = {
        time: 1,
        vehicles: [{ speed: 10, rpm: 2000, gear: 2, wheels: [wheel, wheel] }],
        stages: [{ name: 'solve', ms: 2 }],
    };
    const plots = [...vehiclePlots(0, ['front left', 'rear']), ...solverPlots(['solve'])];
    const read = (id, from) => plots.find((plot) => plot.id === id).series.map((series) => series.read(from));
    assert.deepEqual(read('speed', message), [36]);
    assert.deepEqual(read('load', message), [3, 3]);
    assert.deepEqual(read('slip-angle', message).map(Math.round), [1, 1]);
    assert.deepEqual(read('solver', message), [2]);
    assert.deepEqual(
        plots.find((plot) => plot.id === 'load').series.map(({ label }) => label),
        ['FL', 'R'],
    );
    assert.deepEqual(read('load', { time: 2 }), [null, null]);
});

test('the margin of a limit is the way to the nearer end', () => {
    assert.ok(Math.abs(limitMargin({ value: 0, lower: -1, upper: 0.5 }) - 28.6479) < 1e-3);
    assert.ok(limitMargin({ value: 1, lower: -1, upper: 0.5 }) < 0);
    assert.equal(limitMargin({ value: 1, lower: null, upper: null }), null);
});

test('frames that come slowly are blended, others are shown as they come', () => {
    const clock = new FrameClock();
    clock.receive(0, true);
    clock.receive(100, true);
    assert.equal(clock.place(150), 0.5);
    assert.equal(clock.place(300), 1);
    clock.receive(116, true);
    assert.equal(clock.place(116), 1);
    clock.receive(216, false);
    assert.equal(clock.place(220), 1);
});

test('slow pictures become coarser step by step, fast ones finer, more slowly after each setback', () => {
    const run = (quality, elapsed, frames) => {
        for (let i = 0; i < frames; ++i) quality.frame(elapsed);
        return quality.level;
    };
    const warm = (level) => {
        const quality = new Quality(level);
        run(quality, 500, 5); // while shaders are made, pictures may take their time
        assert.equal(quality.level, level);
        return quality;
    };
    const slow = warm(1);
    assert.equal(run(slow, 100, 6), 2);
    assert.equal(run(slow, 100, 1000), LEVELS.length - 1);
    assert.equal(run(warm(1), 300, 3), 3);
    assert.equal(run(warm(2), 10, 2000), 0);
    assert.equal(run(warm(3), 30, 2000), 3);
    const learned = warm(0);
    run(learned, 100, 6);
    assert.equal(run(learned, 10, 300), 1);
    assert.equal(run(learned, 10, 300), 0);
});

test('tunables are found by their folders and by words', () => {
    const tunable = (path, group, meaning) => ({ path, group, label: path.split('/').pop(), meaning });
    const all = [
        tunable('a/mass', 'car / chassis', 'of all'),
        tunable('a/w/0/mass', 'car / wheels / left', 'of the wheel'),
        tunable('g', 'world', ''),
    ];
    const tree = groupTree(all);
    assert.deepEqual([...tree.branches.keys()], ['car', 'world']);
    assert.deepEqual(tree.branches.get('car').branches.get('wheels').branches.get('left').tunables, [all[1]]);
    assert.deepEqual(findTunables(all, 'LEFT mass'), [all[1]]);
    assert.deepEqual(findTunables(all, 'mass'), [all[0], all[1]]);
    assert.deepEqual(findTunables(all, 'nothing'), []);
});
