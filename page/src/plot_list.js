/** The plots: which curves there are and what they show of a telemetry message. Pure data, drawn by plots.js. */

const DEGREES = 180 / Math.PI;
const PALETTE = ['#e8895c', '#62aedb', '#93c47d', '#d9b650', '#b892d9', '#e07a9a', '#5fc2b4', '#a8b0bb'];

/** "front left" → "FL" */
function shortName(name, index) {
  const letters = name
    .split(/[\s_-]+/)
    .map((word) => word[0]?.toUpperCase() ?? '')
    .join('');
  return letters || String(index + 1);
}

/** Plots of a car. @param {number} vehicle index  @param {string[]} wheels their names */
export function vehiclePlots(vehicle, wheels) {
  const car = (message) => message.vehicles?.[vehicle];
  const perWheel = (read) =>
    wheels.map((name, i) => ({
      label: shortName(name, i),
      color: PALETTE[i % PALETTE.length],
      read: (message) => {
        const wheel = car(message)?.wheels?.[i];
        return wheel ? read(wheel) : null;
      },
    }));
  return [
    {
      id: 'speed',
      title: 'Speed',
      unit: 'km/h',
      digits: 0,
      half: true,
      series: [
        { label: 'speed', color: PALETTE[1], read: (message) => (car(message) ? car(message).speed * 3.6 : null) },
      ],
    },
    {
      id: 'rpm',
      title: 'Engine',
      unit: 'rpm',
      digits: 0,
      half: true,
      series: [{ label: 'rpm', color: PALETTE[0], read: (message) => car(message)?.rpm ?? null }],
    },
    {
      id: 'gear',
      title: 'Gear',
      unit: '',
      digits: 0,
      half: true,
      steps: true,
      ceiling: 5,
      series: [{ label: 'gear', color: PALETTE[3], read: (message) => car(message)?.gear ?? null }],
    },
    {
      id: 'slip-ratio',
      title: 'Slip ratio',
      unit: '',
      digits: 2,
      span: 0.2,
      clip: 1,
      series: perWheel((wheel) => wheel.slipRatio),
    },
    {
      id: 'slip-angle',
      title: 'Slip angle',
      unit: '°',
      digits: 1,
      span: 6,
      clip: 50,
      series: perWheel((wheel) => wheel.slipAngle * DEGREES),
    },
    { id: 'load', title: 'Wheel load', unit: 'kN', digits: 1, series: perWheel((wheel) => wheel.load / 1000) },
    {
      id: 'longitudinal',
      title: 'Force along',
      unit: 'kN',
      digits: 1,
      span: 1,
      series: perWheel((wheel) => wheel.longitudinal / 1000),
    },
    {
      id: 'lateral',
      title: 'Force across',
      unit: 'kN',
      digits: 1,
      span: 1,
      series: perWheel((wheel) => wheel.lateral / 1000),
    },
  ];
}

/** Distance of a joint's angle to its nearer limit, degrees; negative beyond it. */
export function limitMargin({ value, lower, upper }) {
  const margins = [
    lower === null || lower === undefined ? Infinity : value - lower,
    upper === null || upper === undefined ? Infinity : upper - value,
  ];
  const least = Math.min(...margins);
  return Number.isFinite(least) ? least * DEGREES : null;
}

/** Plots of the joint of the picked bone. @param {{node: number, joint: Object}} picked */
export function jointPlots({ node, joint }) {
  const of = (message) => (message.picked?.node === node ? message.picked.joint : undefined);
  return [
    {
      id: 'joint-torque',
      title: 'Torque',
      unit: 'N m',
      digits: 1,
      half: true,
      series: [{ label: joint.name, color: PALETTE[4], read: (message) => of(message)?.torque ?? null }],
    },
    {
      id: 'joint-margin',
      title: 'To limit',
      unit: '°',
      digits: 0,
      half: true,
      series: joint.margins.map(({ axis }, i) => ({
        label: axis,
        color: PALETTE[(i + 4) % PALETTE.length],
        read: (message) => {
          const margin = of(message)?.margins?.[i];
          return margin ? limitMargin(margin) : null;
        },
      })),
    },
  ];
}

/** Plots of the time of a step: all of it, and its stages. @param {string[]} stages their names */
export function solverPlots(stages) {
  return [
    {
      id: 'step-time',
      title: 'Step',
      unit: 'ms',
      digits: 1,
      half: true,
      series: [
        {
          label: 'step',
          color: PALETTE[7],
          read: ({ stages: all = [] }) => (all.length > 0 ? all.reduce((sum, { ms }) => sum + ms, 0) : null),
        },
      ],
    },
    {
      id: 'solver',
      title: 'Stages',
      unit: 'ms',
      digits: 1,
      tall: true,
      series: stages.map((name, i) => ({
        label: name,
        color: PALETTE[i % PALETTE.length],
        read: (message) => message.stages?.find((stage) => stage.name === name)?.ms ?? null,
      })),
    },
  ];
}
