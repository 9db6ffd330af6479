import { byId, el, takesKeys } from './dom.js';

const DRIVING = new Set(['KeyW', 'KeyA', 'KeyS', 'KeyD', 'ArrowUp', 'ArrowLeft', 'ArrowDown', 'ArrowRight', 'Space']);

/**
 * The keys that do something at once. Each row is listed on screen: keys, a word and the whole story, whether it needs
 * the program, and per code what to do.
 * @param {Object} act the actions of the page
 */
function rowsFor(act) {
  return [
    { keys: 'P', what: 'play', more: 'play or pause', codes: { KeyP: act.playOrPause } },
    { keys: 'R', what: 'restart', more: 'back to the beginning', codes: { KeyR: act.reset } },
    {
      keys: ', .',
      what: 'step',
      more: 'step back, step on; with Shift a second',
      codes: {
        Comma: (event) => act.step(event.shiftKey ? -60 : -1),
        Period: (event) => act.step(event.shiftKey ? 60 : 1),
        KeyO: () => act.step(1),
      },
    },
    {
      keys: '[ ]',
      what: 'speed',
      more: 'slower, faster',
      codes: { BracketLeft: act.slower, BracketRight: act.faster },
    },
    {
      keys: 'W A S D',
      what: 'drive',
      more: 'throttle, left, brake and back, right; arrows too',
      live: true,
      codes: {},
    },
    { keys: 'Space', what: 'handbrake', live: true, codes: {} },
    {
      keys: 'Q E X',
      what: 'gears',
      more: 'gear down, up, automatic',
      live: true,
      codes: { KeyQ: () => act.shift(-1), KeyE: () => act.shift(1), KeyX: act.shiftAutomatically },
    },
    {
      keys: 'T V',
      what: 'cars',
      more: 'put the car back, next car',
      live: true,
      codes: { KeyT: act.resetVehicle, KeyV: act.nextVehicle },
    },
    { keys: 'C', what: 'camera', more: 'next camera', codes: { KeyC: act.nextCamera } },
    { keys: 'F', what: 'look at', more: 'look at the picked body or the car', codes: { KeyF: act.frame } },
    { keys: 'B', what: 'shoot', more: 'shoot a ball to the pointer', live: true, codes: { KeyB: act.shoot } },
    { keys: 'H', what: 'panels', more: 'hide or show the panels', codes: { KeyH: act.togglePanels } },
    { keys: 'click', what: 'pick', more: 'see the numbers of a body', live: true, codes: {} },
    { keys: 'Esc', what: 'let go', more: 'of what is held and picked', live: true, codes: { Escape: act.letGo } },
    { keys: 'drag', what: 'throw', more: 'a body; elsewhere it turns the camera', codes: {} },
    { keys: 'wheel', what: 'zoom', more: 'nearer, farther; also what is held', codes: {} },
  ];
}

/** Lists the keys and listens to them. */
export function bindKeys(act, driving) {
  const rows = rowsFor(act);
  byId('keys').append(
    ...rows.map(({ keys, what, more, live }) =>
      el(
        'div',
        { class: live && 'live', title: more },
        el('dt', {}, ...keys.split(' ').map((key) => el('kbd', {}, key))),
        el('dd', {}, what),
      ),
    ),
  );
  const actions = new Map(rows.flatMap(({ codes }) => Object.entries(codes)));
  window.addEventListener('keydown', (event) => {
    if (takesKeys(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    if (DRIVING.has(event.code) && driving.vehicles.length > 0) driving.hold(event.code);
    else if (actions.has(event.code) && (!event.repeat || event.code === 'Comma' || event.code === 'Period'))
      actions.get(event.code)(event);
    else return;
    event.preventDefault();
  });
  window.addEventListener('keyup', (event) => {
    driving.letGo(event.code);
    // A focused button would take the handbrake for a click.
    if (event.code === 'Space' && driving.vehicles.length > 0 && !takesKeys(event.target)) event.preventDefault();
  });
}
