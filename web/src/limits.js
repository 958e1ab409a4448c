// What page and worker agree about.

/** Sets name the files that belong to them: only they are read. */
export const isSet = (name) => /\.(conf|mlp|aln)$/i.test(name);

/** What a page may have, and what every run asks for: the page tells it, the worker plans with it. */
export const pageBytes = 4 * 2 ** 30;
export const runParameters = {
  surface: {distance: true, gap: true},
  memory: {limit: pageBytes - 2 ** 26}, // the engine itself stands beside
};
