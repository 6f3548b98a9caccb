# Quello che ogni pagina ha.

list = { $first } e { $last }
to-console = Alla console
language = Lingua

## STOP. Dove va un valore, il suo script lo mette al posto di {}.

stop-note = ferma subito tutti i robot
stop-soon = STOP è in viaggio…
stop-confirmed = STOP è confermato.
stop-unconfirmed = STOP non è confermato: { "{}" }. Usare l'interruttore del robot. Questa pagina continua a provare.
stop-left = la pagina è stata lasciata prima
stop-says = hallsweep dice: { "{}" }
stop-silent = nessuna risposta
stop-cut = non c'è collegamento
