import assert from 'node:assert/strict';
import { test } from 'node:test';
import { Driver, NO_WISH, strongest, wishOfGamepad, wishOfKeys } from '../src/driver.js';

function hold(driver, wish, speed, seconds) {
    let input;
    for (let time = 0; time < seconds; time += 1 / 60) input = driver.update({ ...NO_WISH, ...wish }, speed, 1 / 60);
    return input;
}

test('keys and arrows mean the same', () => {
    assert.deepEqual(wishOfKeys(new Set(['KeyW', 'KeyA', 'Space'])), {
        throttle: 1,
        brake: 0,
        steer: -1,
        handbrake: 1,
    });
    assert.deepEqual(
        wishOfKeys(new Set(['ArrowUp', 'ArrowLeft', 'Space'])),
        wishOfKeys(new Set(['KeyW', 'KeyA', 'Space'])),
    );
    assert.equal(wishOfKeys(new Set(['KeyA', 'KeyD'])).steer, 0);
});

test('a stick near its middle does nothing, at its end everything', () => {
    const pad = (steer) => ({ axes: [steer], buttons: Array.from({ length: 17 }, () => ({ value: 0 })) });
    assert.equal(wishOfGamepad(pad(0.1)).steer, 0);
    assert.ok(Math.abs(wishOfGamepad(pad(-1)).steer + 1) < 1e-12);
    assert.deepEqual(strongest(NO_WISH, { ...NO_WISH, brake: 0.4 }), { ...NO_WISH, brake: 0.4 });
});

test('a pedal under a key goes down in a third of a second and comes up faster', () => {
    const driver = new Driver();
    const first = hold(driver, { throttle: 1 }, 10, 0.1).throttle;
    assert.ok(first > 0.2 && first < 0.5);
    assert.equal(hold(driver, { throttle: 1 }, 10, 0.5).throttle, 1);
    assert.equal(hold(driver, {}, 10, 0.25).throttle, 0);
});

test('the brake drives backwards once the car stands, the throttle forwards again', () => {
    const driver = new Driver();
    const braking = hold(driver, { brake: 1 }, 10, 1);
    assert.deepEqual([braking.gear, braking.brake, braking.throttle], [null, 1, 0]);
    const backing = hold(driver, { brake: 1 }, 0.1, 1);
    assert.deepEqual([backing.gear, backing.brake, backing.throttle], [-1, 0, 1]);
    const stopping = hold(driver, { throttle: 1 }, -5, 1);
    assert.deepEqual([stopping.gear, stopping.brake, stopping.throttle], [-1, 1, 0]);
    assert.equal(hold(driver, { throttle: 1 }, 0, 1).gear, null);
});

test('gears chosen by hand stay', () => {
    const driver = new Driver();
    driver.shift(2, 1);
    assert.equal(hold(driver, { throttle: 1 }, 10, 0.1).gear, 3);
    assert.equal(hold(driver, { brake: 1 }, 0, 1).gear, 3);
    driver.shift(-1, -1);
    assert.equal(driver.gear, -1);
});
