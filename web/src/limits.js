// What a page may have: the page tells it, the worker plans with it.
export const pageBytes = 4 * 2 ** 30;
/** A run's, beside the engine itself. */
export const runBytes = pageBytes - 2 ** 26;
