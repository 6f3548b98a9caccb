# Quello che ogni pagina ha.

list = { $first } e { $last }
to-console = Alla console

## STOP. Dove va un valore, il suo script lo mette al posto di {}.

stop-note = ferma subito tutti i robot
stop-soon = STOP è in viaggio…
stop-confirmed = STOP è confermato.
stop-unconfirmed = STOP non è confermato: { "{}" }. Usare l'interruttore del robot. Questa pagina continua a provare.
stop-left = la pagina è stata lasciata prima
stop-says = hallsweep dice: { "{}" }
stop-silent = nessuna risposta
stop-cut = non c'è collegamento

## The bar of other pages than the console.

bar-as-of = alle { $time } ({ $zone })
bar-over = La sessione è finita: accedere di nuovo, in un'altra scheda se qui c'è qualcosa da conservare.
bar-silent = Nessuna risposta da hallsweep: quello che si legge qui può non essere più vero.

## Months, in short.

month-Jan = gen
month-Feb = feb
month-Mar = mar
month-Apr = apr
month-May = mag
month-Jun = giu
month-Jul = lug
month-Aug = ago
month-Sep = set
month-Oct = ott
month-Nov = nov
month-Dec = dic
