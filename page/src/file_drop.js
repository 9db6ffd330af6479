import { byId } from './dom.js';

/** Takes a file by drag and drop anywhere on the page, or by the button. @param {function(File)} take */
export function acceptFiles(take) {
  const chooser = byId('recording-file');
  byId('open-recording').addEventListener('click', () => chooser.click());
  chooser.addEventListener('change', () => {
    if (chooser.files.length > 0) take(chooser.files[0]);
    chooser.value = '';
  });
  const hint = byId('drop-hint');
  window.addEventListener('dragover', (event) => {
    event.preventDefault();
    hint.hidden = false;
  });
  window.addEventListener('dragleave', (event) => {
    if (event.relatedTarget === null) hint.hidden = true;
  });
  window.addEventListener('drop', (event) => {
    event.preventDefault();
    hint.hidden = true;
    if (event.dataTransfer.files.length > 0) take(event.dataTransfer.files[0]);
  });
}
