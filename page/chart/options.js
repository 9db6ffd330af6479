// What ECharts draws of a chart's document: the same for the page and for the picture.

/** A chart's document from its text: points come by columns, and texts once each. */
export function documentOf(text) {
  const document = JSON.parse(text);
  const { numbers, texts } = document.points;
  const columns = { ...numbers };
  for (const [name, { each, at }] of Object.entries(texts)) columns[name] = at.map((i) => each[i]);
  const names = Object.keys(columns);
  const count = columns.scene?.length ?? 0;
  document.points = Array.from({ length: count }, (_, i) => Object.fromEntries(names.map((name) => [name, columns[name][i]])));
  return document;
}

/** Colours that the colour-blind tell apart [Okabe, Ito, Color Universal Design, 2008], two more from [Tol, Colour
 * schemes, 2021], and shapes for print. */
const LOOKS = [
  { color: '#0072b2', symbol: 'circle' },
  { color: '#d55e00', symbol: 'rect' },
  { color: '#009e73', symbol: 'triangle' },
  { color: '#cc79a7', symbol: 'diamond' },
  { color: '#e69f00', symbol: 'path://M0 0L8 0L4 8Z' },
  { color: '#56b4e9', symbol: 'path://M3 0H5V3H8V5H5V8H3V5H0V3H3Z' },
  { color: '#882255', symbol: 'path://M0 2H8V6H0Z' },
  { color: '#777777', symbol: 'path://M2 0H6V8H2Z' },
];
const CROSS = 'path://M0 1L1 0L4 3L7 0L8 1L5 4L8 7L7 8L4 5L1 8L0 7L3 4Z';

const THEMES = {
  light: { text: '#1b1f24', soft: '#5b6570', line: '#d5dae0', back: '#ffffff' },
  dark: { text: '#e4e7eb', soft: '#9aa4af', line: '#343a42', back: '#15181c' },
};

/** The engines of a document, each with how it looks. */
export function looksOf(document) {
  const engines = [...new Set(document.variants.map((variant) => variant.engine))];
  return new Map(engines.map((engine, i) => [engine, LOOKS[i % LOOKS.length]]));
}

function powerBelow(value) {
  return 10 ** Math.floor(Math.log10(value) + 1e-9);
}

function powerAbove(value) {
  return 10 ** Math.ceil(Math.log10(value) - 1e-9);
}

/** Where the points of a scene are, in the view that is asked for. */
export function placesOf(document, scene, view) {
  const mine = [];
  document.points.forEach((point, index) => {
    if (point.scene === scene.name && view.engines.has(point.engine)) mine.push({ point, index });
  });
  const times = mine.filter(({ point }) => point.alone && point.ms > 0).map(({ point }) => point.ms);
  const left = times.length ? powerBelow(Math.min(...times)) : 0.01;
  const right = times.length ? powerAbove(Math.max(...times)) : 1;
  // Points whose time does not count stand at the left edge, those that failed on a rail at the top.
  const rail = scene.failsFrom * 4;
  const places = mine.map(({ point, index }) => {
    const error = view.axis === 'error' ? point.error : point.consistency;
    return {
      point,
      index,
      x: point.alone && point.ms > 0 ? point.ms : left,
      y: point.outcome === 'failed' ? rail : error === null ? null : Math.min(Math.max(error, scene.floor), rail / 2),
    };
  });
  return { places, left, right: Math.max(right, 10 * left), rail };
}

function frontOf(document, scene, engine, at) {
  const front = document.fronts.find((each) => each.scene === scene.name && each.engine === engine);
  return (front?.points ?? []).map((index) => at.get(index)).filter((place) => place && place.y !== null);
}

/** Bars from the least to the most of what repeats gave, in both directions. */
function intervalSeries(places, scene, color) {
  return {
    type: 'custom',
    silent: true,
    z: 1,
    data: places.map(({ point, x, y }) => [x, y, point.alone ? point.msLow ?? x : x, point.alone ? point.msHigh ?? x : x,
      Math.max(point.errorLow ?? y, scene.floor), Math.max(point.errorHigh ?? y, scene.floor)]),
    renderItem(_, api) {
      const at = (x, y) => api.coord([x, y]);
      const [x, y, xLow, xHigh, yLow, yHigh] = [0, 1, 2, 3, 4, 5].map((i) => api.value(i));
      const bar = ([x1, y1], [x2, y2]) => ({ type: 'line', shape: { x1, y1, x2, y2 }, style: { stroke: color, opacity: 0.45 } });
      return { type: 'group', children: [bar(at(xLow, y), at(xHigh, y)), bar(at(x, yLow), at(x, yHigh))] };
    },
  };
}

function marks(places, look, options) {
  return {
    type: 'scatter',
    data: places.map(({ x, y, index }) => ({ value: [x, y], index })),
    symbol: look.symbol,
    itemStyle: { color: look.color, opacity: 0.55 },
    cursor: 'pointer',
    ...options,
  };
}

function engineSeries(document, scene, view, theme, engine, look, places) {
  const mine = places.filter(({ point }) => point.engine === engine);
  const at = new Map(mine.map((place) => [place.index, place]));
  const front = frontOf(document, scene, engine, at);
  const onFront = new Set(front.map(({ index }) => index));
  const measured = mine.filter(({ point, y }) => point.outcome === 'measured' && y !== null);
  const shown = view.fronts ? measured.filter(({ index }) => onFront.has(index)) : measured;
  const series = [marks(shown.filter(({ index }) => !onFront.has(index)), look, { symbolSize: 5 })];
  series.push(marks(shown.filter(({ index }) => onFront.has(index)), look,
    { symbolSize: 8, z: 3, itemStyle: { color: look.color, opacity: 1 } }));
  if (view.axis === 'error')
    series.push({ type: 'line', silent: true, symbol: 'none', step: 'end', z: 2, data: front.map(({ x, y }) => [x, y]),
      lineStyle: { color: look.color, width: 2 } });
  series.push(marks(measured.filter(({ point }) => point.standard), { ...look, symbol: 'circle' },
    { symbolSize: 15, z: 4, silent: true, itemStyle: { color: 'transparent', borderColor: look.color, borderWidth: 2 } }));
  if (view.intervals && view.axis === 'error') series.push(intervalSeries(shown, scene, look.color));
  if (view.failures && !view.fronts)
    series.push(marks(mine.filter(({ point }) => point.outcome === 'failed'), { ...look, symbol: CROSS }, { symbolSize: 8 }));
  return series;
}

function logAxis(theme, name, range) {
  return {
    type: 'log',
    name,
    nameLocation: 'middle',
    nameTextStyle: { color: theme.soft },
    axisLabel: { color: theme.soft, formatter: (value) => value >= 0.01 && value < 1e5 ? `${+value.toPrecision(1)}` : value.toExponential(0) },
    axisLine: { lineStyle: { color: theme.soft } },
    splitLine: { lineStyle: { color: theme.line } },
    ...range,
  };
}

/** One scene: error over time. `view` has engines (a set), axis, failures, intervals, fronts, theme, and linked: a
 * variant and setting whose points are ringed, or null. */
export function panelOption(document, scene, view) {
  const theme = THEMES[view.theme];
  const looks = looksOf(document);
  const { places, left, right, rail } = placesOf(document, scene, view);
  const series = [...view.engines].filter((engine) => looks.has(engine))
    .flatMap((engine) => engineSeries(document, scene, view, theme, engine, looks.get(engine), places));
  const linked = view.linked ? places.filter(({ point, y }) => y !== null && point.variant === view.linked) : [];
  series.push(marks(linked, { color: theme.text, symbol: 'circle' },
    { symbolSize: 11, z: 5, silent: true, itemStyle: { color: 'transparent', borderColor: theme.text, borderWidth: 1 } }));
  return {
    animation: false,
    backgroundColor: view.background ? theme.back : 'transparent',
    title: { text: scene.title, subtext: `${scene.kind}: ${scene.how}`, left: 8, top: 4, itemGap: 7,
      textStyle: { color: theme.text, fontSize: 14 }, subtextStyle: { color: theme.soft, fontSize: 11 } },
    grid: { left: 58, right: 14, top: 58, bottom: 40 },
    xAxis: logAxis(theme, 'ms of processor time per simulated second', { nameGap: 24, min: left, max: right }),
    yAxis: logAxis(theme, view.axis === 'error' ? 'error' : 'self-consistency', { nameGap: 40,
      min: powerBelow(scene.floor), max: powerAbove(rail) }),
    series,
  };
}

/** Shares of problems solved within a factor of the fastest. */
export function profileOption(document, view) {
  const theme = THEMES[view.theme];
  const looks = looksOf(document);
  const most = Math.max(10, ...document.profiles.flatMap(({ steps }) => steps.map(([ratio]) => ratio)));
  return {
    animation: false,
    grid: { left: 58, right: 90, top: 14, bottom: 44 },
    xAxis: logAxis(theme, 'time, in that of the fastest', { nameGap: 26, min: 1, max: powerAbove(most) }),
    yAxis: { ...logAxis(theme, 'share', { nameGap: 40, min: 0, max: 1 }), type: 'value', axisLabel: { color: theme.soft } },
    series: document.profiles.filter(({ engine, steps }) => view.engines.has(engine) && steps.length > 0)
      .map(({ engine, steps }) => ({
        type: 'line',
        step: 'end',
        symbol: looks.get(engine).symbol,
        symbolSize: 5,
        data: [...steps, [powerAbove(most), steps.at(-1)[1]]],
        lineStyle: { color: looks.get(engine).color },
        itemStyle: { color: looks.get(engine).color },
        endLabel: { show: true, formatter: engine, color: looks.get(engine).color },
      })),
  };
}
