import assert from 'node:assert/strict';
import { test } from 'node:test';
import { differs, formatNumber, scaleWith, sliderScale, toPlace, toValue } from '../src/slider_scale.js';

const number = (min, max, standard) => ({ min, max, default: standard, value: standard, kind: 'number' });

test('a range of the size of its default is taken as declared', () => {
    assert.deepEqual(sliderScale(number(0, 10, 1.05)), { lower: 0, upper: 10, kind: 'linear', whole: false });
    assert.deepEqual(sliderScale(number(0, 1, 0)), { lower: 0, upper: 1, kind: 'linear', whole: false });
});

test('some decades of positive numbers are shown whole, by a logarithm', () => {
    const scale = sliderScale(number(0.1, 20, 1.4));
    assert.deepEqual(scale, { lower: 0.1, upper: 20, kind: 'log', whole: false });
    assert.equal(toValue(scale, 0.5), 1.41);
});

test('a wide range of positive numbers runs a decade each way from the default', () => {
    const scale = sliderScale(number(1e-3, 1e9, 1200));
    assert.deepEqual(scale, { lower: 120, upper: 12000, kind: 'log', whole: false });
    assert.equal(toValue(scale, 0.5), 1200);
    assert.deepEqual(sliderScale(number(0, 1e12, 2000)).kind, 'log');
});

test('without bounds, or around zero, the slider has a range all the same', () => {
    const unbounded = sliderScale(number(null, null, 0));
    assert.ok(unbounded.lower < 0 && unbounded.upper > 0 && Number.isFinite(unbounded.upper - unbounded.lower));
    const brake = sliderScale(number(0, 1e12, 0));
    assert.deepEqual([brake.lower, brake.kind], [0, 'power']);
    const absent = sliderScale({ ...number(1e-3, 1e12, null), optional: true });
    assert.ok(Number.isFinite(absent.upper));
    const place = sliderScale(number(-1e4, 1e4, 0.74));
    assert.ok(place.lower < 0.74 && place.upper > 0.74 && place.upper < 10);
});

test('whole numbers stay whole', () => {
    const scale = sliderScale({ ...number(1, 64, 4), kind: 'integer' });
    for (let place = 0; place <= 1; place += 0.01) assert.ok(Number.isInteger(toValue(scale, place)));
});

test('place and value are each the inverse of the other, and never leave the range', () => {
    const cases = [
        number(0.1, 20, 1.4),
        number(1e-3, 1e9, 1200),
        number(0, 1e12, 0),
        number(null, null, -3),
        number(-1, 1, 0),
    ];
    for (const declared of cases) {
        const scale = sliderScale(declared);
        for (let place = 0; place <= 1; place += 0.05) {
            const value = toValue(scale, place);
            assert.ok(value >= scale.lower && value <= scale.upper);
            assert.ok(Math.abs(toPlace(scale, value) - place) < 0.01, `${JSON.stringify(scale)} at ${place}`);
        }
        assert.equal(toValue(scale, 0), scale.lower);
        assert.equal(toValue(scale, 1), scale.upper);
    }
});

test('a value outside makes the slider longer', () => {
    const scale = scaleWith(sliderScale(number(1e-3, 1e9, 1200)), 50000);
    assert.equal(scale.upper, 50000);
    assert.equal(toPlace(scale, 50000), 1);
    const base = sliderScale(number(1e-3, 1e9, 1200));
    assert.equal(scaleWith(base, 200), base);
    assert.equal(scaleWith(base, null), base);
});

test('numbers are written as people write them', () => {
    assert.equal(formatNumber(1.350000023841858), '1.35');
    assert.equal(formatNumber(1200), '1200');
    assert.equal(formatNumber(null), '');
});

test('a float that was written and read back is unchanged', () => {
    assert.equal(differs(1.350000023841858, 1.35), false);
    assert.equal(differs(1.35, 1.36), true);
    assert.equal(differs([0, 1, 2], [0, 1, 2]), false);
    assert.equal(differs([0, 1, 2], [0, 1, 2.1]), true);
    assert.equal(differs(null, undefined), false);
    assert.equal(differs(null, 5), true);
    assert.equal(differs('open', 'locked'), true);
});
