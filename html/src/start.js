// Start of the program: a player of recorded motions, or a view of a running simulation.

import { read } from './data.js';
import { LivePlayer } from './live.js';
import { Player } from './main.js';

globalThis.replay((buffer) => {
  const data = read(buffer);
  return (data.description.live ? LivePlayer : Player).create(data);
});
