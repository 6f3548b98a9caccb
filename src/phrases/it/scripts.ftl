# What scripts say: a line each, and in it only values.

## attention

attention-waits = Il bagaglio #{ $id } attende il verdetto.
attention-denied = Questo browser non consente notifiche di questa pagina: lo dicono le sue impostazioni per questo indirizzo.
attention-unknown = Questo browser non ha notifiche per questo indirizzo: per questo vuole https.

## console

console-changed = Il bagaglio è appena cambiato: non è stato inviato niente. Guardare, poi premere di nuovo.
console-twice = È arrivato con la pressione precedente: non è stato inviato. Premere di nuovo.
console-refused = È stato rifiutato ({ $status }).
console-silent = Nessuna risposta. Può ancora essere eseguito: guardare il robot prima di riprovare.
console-cut = Nessun collegamento: non è arrivato.

## editor

## hall

hall-ruler-metres = { $length } m
hall-ruler-cells = { $length } celle
hall-go = Vai a colonna { $x }, riga { $y }
hall-cell = colonna { $x }, riga { $y }

## laboratory

## pallet

## photo

## replay

## roomba

## simulator

## time

time-moment = { $time }, voce { $seq } della missione { $mission }
time-now = adesso
time-pause = Pausa
time-play = Riproduci
time-cut = Nessun collegamento: il passato non si può mostrare adesso.

## trees

## verdict
