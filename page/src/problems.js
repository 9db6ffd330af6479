const LOST = 'lost';

/** Tells the reader what went wrong: in the program, in a file, with the connection. */
export function reportProblems(session, toasts) {
  session.on('problem', (text) => toasts.show('error', text));
  session.on('scene', ({ warnings = [] }) => {
    for (const warning of warnings.slice(0, 3)) toasts.show('info', warning);
    if (warnings.length > 3) toasts.show('info', `and ${warnings.length - 3} more warnings`);
  });
  session.on('file', ({ path, ok, message }) => {
    if (ok) toasts.show('good', message || `${path} was read again`, { key: path });
    else toasts.show('error', `${message} – the values before stay`, { key: path, stay: true });
  });
  session.on('connected', (connected) => {
    if (connected) toasts.dismiss(LOST);
    else toasts.show('error', 'No connection to the program; trying again …', { key: LOST, stay: true });
  });
}
