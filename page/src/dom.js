/** The element with this id; the page cannot work without it. */
export function byId(id) {
  const element = document.getElementById(id);
  if (!element) throw new Error(`the page has no element #${id}`);
  return element;
}

/**
 * Makes an element. Strings among the children become text, so nothing from outside is ever read as HTML.
 * @param {string} tag
 * @param {Object} attributes `on…` are listeners, `class`, `dataset` and booleans work as one expects
 * @param {...(Node|string|null)} children
 */
export function el(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (name === 'dataset') Object.assign(element.dataset, value);
    else if (value === true) element.setAttribute(name, '');
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** Sets the text of an element, touching the document only when it differs. */
export function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

/** Is a key meant for this element rather than for the scene? */
export function takesKeys(element) {
  return (
    element instanceof HTMLElement &&
    (element.matches('select, textarea') ||
      element.isContentEditable ||
      (element.matches('input') && !['range', 'checkbox'].includes(element.type)))
  );
}
