# Quello che ogni pagina ha.

list = { $first } e { $last }
to-console = Alla console

## La barra a sinistra e il suo menu.

rail = Pagine di hallsweep
rail-operate = Operazioni
rail-interface = API
rail-menu = Opzioni
colours = Colori
colours-system = come il sistema
colours-light = chiari
colours-dark = scuri
colours-contrast = contrasto alto

## STOP. Dove va un valore, il suo script lo mette al posto di {}.

stop-note = ferma tutti i robot
stop-soon = STOP è in viaggio…
stop-confirmed = STOP è confermato.
stop-unconfirmed = STOP non è confermato: { "{}" }. Usare l'interruttore del robot. Questa pagina continua a inviare STOP.
stop-left = la pagina è stata lasciata prima di una risposta
stop-says = hallsweep dice: { "{}" }
stop-silent = nessuna risposta
stop-cut = non c'è collegamento

## The bar of other pages than the console.

bar-as-of = alle { $time } ({ $zone })
bar-over = La sessione è finita. Accedere di nuovo, in un'altra scheda se questa pagina serve ancora.
bar-silent = hallsweep non risponde: quello che si legge in questa pagina può non essere più vero.

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
