/** Tunables by the names between the slashes of their group. */
export function groupTree(tunables) {
  const root = { tunables: [], branches: new Map() };
  for (const tunable of tunables) {
    let at = root;
    for (const name of tunable.group
      .split('/')
      .map((part) => part.trim())
      .filter(Boolean)) {
      if (!at.branches.has(name)) at.branches.set(name, { tunables: [], branches: new Map() });
      at = at.branches.get(name);
    }
    at.tunables.push(tunable);
  }
  return root;
}

/** Tunables in which every word occurs: in path, group, label or meaning. */
export function findTunables(tunables, text) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  return tunables.filter(({ path, group, label, meaning }) => {
    const all = `${path} ${group} ${label} ${meaning}`.toLowerCase();
    return words.every((word) => all.includes(word));
  });
}
